#include "solve/disc_qp.h"

#include <cmath>

namespace monolith {
Eigen::Vector2d minimiseOverDisc(const Eigen::Matrix2d& B, const Eigen::Vector2d& g, double radius) {
  if (!(radius > 0.0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d inside = -B.ldlt().solve(g);
  if (inside.allFinite() && inside.norm() <= radius) return inside;
  // (B + m I) x = -g with |x| = radius, m >= 0: Newton on 1/|x| - 1/radius, which is nearly linear in m.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(B);
  const Eigen::Vector2d b = eigen.eigenvectors().transpose() * -g;
  const Eigen::Vector2d e = eigen.eigenvalues().cwiseMax(0.0);
  double m = std::max(0.0, b.norm() / radius - e[1]);
  Eigen::Vector2d y = Eigen::Vector2d::Zero();
  for (int it = 0; it < 60; ++it) {
    const Eigen::Vector2d d = e.array() + m;
    y = b.cwiseQuotient(d);
    const double length = y.norm();
    if (std::abs(length - radius) <= 1e-14 * radius) break;
    const double slope = (y.array().square() / d.array()).sum();
    m = std::max(0.0, m + (length - radius) / radius * length * length / slope);
  }
  y *= radius / y.norm();
  return eigen.eigenvectors() * y;
}

DiscQpReport solveDiscQp(const Eigen::MatrixXd& A, const Eigen::VectorXd& q, const Eigen::VectorXd& radius,
                         double tolerance, int maximum_sweeps, Eigen::VectorXd& f) {
  DiscQpReport report;
  const Eigen::Index count = radius.size();
  if (f.size() != 2 * count) f = Eigen::VectorXd::Zero(2 * count);
  const double scale = count > 0 ? radius.maxCoeff() : 0.0;
  if (!(scale > 0.0)) {
    f.setZero();
    report.solved = true;
    return report;
  }
  const double goal = tolerance * q.cwiseAbs().maxCoeff();
  Eigen::VectorXd w = A * f;
  while (report.sweeps < maximum_sweeps) {
    ++report.sweeps;
    const Eigen::VectorXd before = w;
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::Matrix2d B = A.block<2, 2>(2 * c, 2 * c);
      const Eigen::Vector2d old = f.segment<2>(2 * c);
      const Eigen::Vector2d next = minimiseOverDisc(B, q.segment<2>(2 * c) + w.segment<2>(2 * c) - B * old, radius[c]);
      w += A.middleCols<2>(2 * c) * (next - old);
      f.segment<2>(2 * c) = next;
    }
    if ((w - before).cwiseAbs().maxCoeff() <= goal) {
      report.solved = true;
      break;
    }
  }
  return report;
}

}  // namespace monolith
