#include "solve/staggered_projections.h"

#include <cmath>

#include "solve/disc_qp.h"
#include "solve/lcp.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 200;
constexpr int kMaximumSweeps = 5000;
constexpr int kAngles = 72;  // of the search for the direction of slip
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

// Impulse of a contact that slips with friction in direction t (angle): w_n = 0. Returns how far the slip turns from -t,
// positive one way, negative the other; NaN where friction in this direction could not be borne or does not oppose it.
double slipAngle(const Eigen::Matrix3d& B, const Eigen::Vector3d& q, double mu, double angle, Eigen::Vector3d& r) {
  const Eigen::Vector2d t(std::cos(angle), std::sin(angle));
  const double resistance = B(0, 0) + mu * B.block<1, 2>(0, 1).dot(t);
  if (!(resistance > 0.0)) return std::nan("");
  r[0] = -q[0] / resistance;
  r.tail<2>() = mu * r[0] * t;
  const Eigen::Vector2d slip = (B * r + q).tail<2>();
  if (!(slip.dot(t) < 0.0)) return std::nan("");
  return slip[0] * t[1] - slip[1] * t[0];
}

// One contact with the others given, w = B r + q: open, stuck or slipping in the direction found by a search over all.
Eigen::Vector3d solveOneContact(const Eigen::Matrix3d& B, const Eigen::Vector3d& q, double mu, const Eigen::Vector3d& old) {
  if (q[0] >= 0.0) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d stuck = -B.ldlt().solve(q);
  if (stuck.allFinite() && stuck[0] >= 0.0 && stuck.tail<2>().norm() <= mu * stuck[0]) return stuck;
  Eigen::Vector3d r;
  if (mu == 0.0) return {-q[0] / B(0, 0), 0.0, 0.0};
  double low = 0.0, at_low = slipAngle(B, q, mu, low, r);
  for (int i = 1; i <= kAngles; ++i) {
    double high = 2.0 * M_PI * i / kAngles;
    const double at_high = slipAngle(B, q, mu, high, r);
    if (at_low * at_high <= 0.0) {
      double sign = at_low, a = low, b = high;
      for (int it = 0; it < 60; ++it) {
        const double middle = 0.5 * (a + b);
        const double value = slipAngle(B, q, mu, middle, r);
        (value * sign > 0.0 ? a : b) = middle;
      }
      slipAngle(B, q, mu, 0.5 * (a + b), r);
      return r;
    }
    low = high;
    at_low = at_high;
  }
  return old;
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
