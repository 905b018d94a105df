#include "solve/contact_sweeps.h"

#include <cmath>

namespace monolith {
namespace {

constexpr int kMaximumSweeps = 1000;
constexpr int kAngles = 72;  // of the search for the direction of slip

// Impulse of a contact that slips with friction in direction t (angle): w_n = 0. Returns how far the slip turns from
// -t, positive one way, negative the other; NaN where friction in this direction could not be borne or does not oppose
// it.
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
Eigen::Vector3d solveOneContact(const Eigen::Matrix3d& B, const Eigen::Vector3d& q, double mu,
                                const Eigen::Vector3d& old) {
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

}  // namespace

int sweepContacts(const FrictionProblem& problem, Eigen::VectorXd r, ClosestToLaw& closest) {
  const Eigen::MatrixXd& D = problem.D;
  const Eigen::VectorXd &w0 = problem.w0, &mu = problem.mu;
  const Eigen::Index m = problem.count();
  Eigen::VectorXd w = D * r + w0;
  int sweeps = 0;
  while (sweeps < kMaximumSweeps) {
    ++sweeps;
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
    if (closest.offer(r)) break;
  }
  return sweeps;
}

}  // namespace monolith
