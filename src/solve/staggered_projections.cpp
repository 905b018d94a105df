#include "solve/staggered_projections.h"

#include <cmath>

#include "solve/disc_qp.h"
#include "solve/lcp.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 200;
constexpr int kMaximumSweeps = 5000;
constexpr int kMaximumLocal = 200;
// The problems inside are solved this much more closely than their fixed point.
constexpr double kInnerTolerance = 0.1;

double largest(const Eigen::VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }

bool alternate(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, double tolerance,
               Eigen::VectorXd& r, FrictionReport& report) {
  const Eigen::Index m = mu.size();
  const bool frictionless = !(mu.maxCoeff() > 0.0);
  const double scale = std::max(largest(w0), 1e-300);
  if (frictionless) r.tail(2 * m).setZero();
  for (int it = 0; it < kMaximumAlternations; ++it) {
    ++report.iterations;
    const Eigen::VectorXd before = r;
    Eigen::VectorXd lambda;
    const LcpReport lcp =
        solveLcp(D.topLeftCorner(m, m), w0.head(m) + D.topRightCorner(m, 2 * m) * r.tail(2 * m), lambda);
    if (!lcp.solved) return false;
    r.head(m) = lambda;
    if (frictionless) {
      report.residual = 0.0;
      return true;
    }
    Eigen::VectorXd f = r.tail(2 * m);
    const DiscQpReport discs =
        solveDiscQp(D.bottomRightCorner(2 * m, 2 * m), w0.tail(2 * m) + D.bottomLeftCorner(2 * m, m) * lambda,
                    mu.cwiseProduct(lambda), kInnerTolerance * tolerance, f);
    r.tail(2 * m) = f;
    report.residual = largest(D * (r - before)) / scale;
    if (discs.solved && report.residual <= tolerance) return true;
  }
  return false;
}

// One contact with the others given: w = B r + q.
Eigen::Vector3d solveOneContact(const Eigen::Matrix3d& B, const Eigen::Vector3d& q, double mu, Eigen::Vector3d r) {
  if (q[0] >= 0.0 && mu == 0.0) return Eigen::Vector3d::Zero();
  const Eigen::Matrix2d tangent = B.bottomRightCorner<2, 2>();
  for (int it = 0; it < kMaximumLocal; ++it) {
    const Eigen::Vector3d before = r;
    r[0] = std::max(0.0, -(q[0] + B.block<1, 2>(0, 1).dot(r.tail<2>())) / B(0, 0));
    r.tail<2>() = minimiseOverDisc(tangent, q.tail<2>() + B.block<2, 1>(1, 0) * r[0], mu * r[0]);
    if ((r - before).cwiseAbs().maxCoeff() <= 1e-14 * r.cwiseAbs().maxCoeff()) break;
  }
  return r;
}

bool sweep(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, double tolerance,
           Eigen::VectorXd& r, FrictionReport& report) {
  const Eigen::Index m = mu.size();
  report.staggered = false;
  const double scale = std::max(largest(w0), 1e-300);
  Eigen::VectorXd w = D * r + w0;
  for (int it = 0; it < kMaximumSweeps; ++it) {
    ++report.iterations;
    const Eigen::VectorXd before = w;
    for (Eigen::Index c = 0; c < m; ++c) {
      const Eigen::Index at[3] = {c, m + 2 * c, m + 2 * c + 1};
      Eigen::Matrix3d B;
      Eigen::Vector3d old, q;
      for (int i = 0; i < 3; ++i) {
        old[i] = r[at[i]];
        q[i] = w[at[i]];
        for (int j = 0; j < 3; ++j) B(i, j) = D(at[i], at[j]);
      }
      q -= B * old;
      const Eigen::Vector3d step = solveOneContact(B, q, mu[c], old) - old;
      for (int i = 0; i < 3; ++i) {
        r[at[i]] += step[i];
        w += D.col(at[i]) * step[i];
      }
    }
    report.residual = largest(w - before) / scale;
    if (report.residual <= kInnerTolerance * tolerance) return true;
  }
  return false;
}

}  // namespace

FrictionReport solveFrictionalContact(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu,
                                      double tolerance, Eigen::VectorXd& r) {
  FrictionReport report;
  const Eigen::Index m = mu.size();
  if (r.size() != 3 * m) r = Eigen::VectorXd::Zero(3 * m);
  if (m == 0) {
    report.solved = true;
    return report;
  }
  report.solved = alternate(D, w0, mu, tolerance, r, report) || sweep(D, w0, mu, tolerance, r, report);
  return report;
}

}  // namespace monolith
