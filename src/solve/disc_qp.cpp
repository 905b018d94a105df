#include "solve/disc_qp.h"

#include <cmath>

namespace monolith {

DiscMinimiser::DiscMinimiser(const Eigen::Matrix2d& B) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(B);
  vectors_ = eigen.eigenvectors();
  values_ = eigen.eigenvalues().cwiseMax(0.0);
}

Eigen::Vector2d DiscMinimiser::minimise(const Eigen::Vector2d& g, double radius) const {
  if (!(radius > 0.0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d b = vectors_.transpose() * -g;
  const Eigen::Vector2d inside = b.cwiseQuotient(values_);
  if (inside.allFinite() && inside.norm() <= radius) return vectors_ * inside;
  // (B + m I) x = -g with |x| = radius, m >= 0: Newton on 1/|x| - 1/radius, which is nearly linear in m.
  double m = std::max(0.0, b.norm() / radius - values_[1]);
  Eigen::Vector2d y = Eigen::Vector2d::Zero();
  for (int it = 0; it < 60; ++it) {
    const Eigen::Vector2d d = values_.array() + m;
    y = b.cwiseQuotient(d);
    const double length = y.norm();
    if (std::abs(length - radius) <= 1e-14 * radius) break;
    const double slope = (y.array().square() / d.array()).sum();
    m = std::max(0.0, m + (length - radius) / radius * length * length / slope);
  }
  y *= radius / y.norm();
  return vectors_ * y;
}

DiscQp::DiscQp(const Eigen::Ref<const Eigen::MatrixXd>& A) : A_(A) {
  for (Eigen::Index c = 0; c < A.rows() / 2; ++c) discs_.emplace_back(A.block<2, 2>(2 * c, 2 * c));
}

DiscQpReport DiscQp::solve(const Eigen::VectorXd& q, const Eigen::VectorXd& radius, double tolerance,
                           int maximum_sweeps, Eigen::VectorXd& f) const {
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
  Eigen::VectorXd w = A_ * f, before(2 * count);
  while (report.sweeps < maximum_sweeps) {
    ++report.sweeps;
    before = w;
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::Vector2d old = f.segment<2>(2 * c);
      const Eigen::Vector2d by_others = w.segment<2>(2 * c) - A_.block<2, 2>(2 * c, 2 * c) * old;
      const Eigen::Vector2d next = discs_[c].minimise(q.segment<2>(2 * c) + by_others, radius[c]);
      if (next == old) continue;
      w.noalias() += A_.middleCols<2>(2 * c) * (next - old);
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
