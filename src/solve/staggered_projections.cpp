#include "solve/staggered_projections.h"

#include <cmath>
#include <limits>

#include "solve/disc_qp.h"
#include "solve/lcp.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 200;
constexpr int kSweepsPerAlternation = 50;  // of the friction problem, which need not be solved closely
constexpr int kNewtonSteps = 12;
constexpr double kCloser = 0.5;
constexpr int kMaximumSweeps = 1000;
constexpr int kAngles = 72;  // of the search for the direction of slip

double largest(const Eigen::VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }

// Steps of the projection, inverse to the contact's own response.
double normalStep(const Eigen::MatrixXd& D, Eigen::Index c) { return 1.0 / D(c, c); }
double tangentStep(const Eigen::MatrixXd& D, Eigen::Index m, Eigen::Index c) {
  return 1.0 / std::max(D(m + 2 * c, m + 2 * c), D(m + 2 * c + 1, m + 2 * c + 1));
}

// Newton's method on r = P(r - w/D_cc), undamped, from r. The best iterate is returned.
void newton(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, double goal,
            Eigen::VectorXd& r, FrictionReport& report) {
  const Eigen::Index m = mu.size();
  Eigen::VectorXd x = r;
  double best = coulombResidual(D, w0, mu, r);
  for (int it = 0; it < kNewtonSteps && best > goal; ++it) {
    ++report.iterations;
    const Eigen::VectorXd w = D * x + w0;
    // Contacts that do not press have no impulse; the others' rows are solved for.
    std::vector<Eigen::Index> pressing;
    for (Eigen::Index c = 0; c < m; ++c) {
      if (x[c] - normalStep(D, c) * w[c] > 0.0) pressing.push_back(c);
    }
    const auto k = static_cast<Eigen::Index>(pressing.size());
    std::vector<Eigen::Index> entry(3 * k);
    for (Eigen::Index i = 0; i < k; ++i) {
      entry[i] = pressing[i];
      for (int d = 0; d < 2; ++d) entry[k + 2 * i + d] = m + 2 * pressing[i] + d;
    }
    Eigen::VectorXd change = -x, moved = w;
    for (const Eigen::Index e : entry) change[e] = 0.0;
    moved += D * change;
    Eigen::MatrixXd A = D(entry, entry);
    Eigen::VectorXd residual = moved(entry);
    for (Eigen::Index i = 0; i < k; ++i) {
      const Eigen::Index c = pressing[i], t = k + 2 * i;
      const double step = tangentStep(D, m, c);
      const Eigen::Vector2d f = x.segment<2>(m + 2 * c), trial = f - step * w.segment<2>(m + 2 * c);
      const double length = trial.norm(), radius = mu[c] * std::max(x[c], 0.0);
      if (length <= radius) continue;
      const Eigen::Vector2d along = trial / length;
      const Eigen::Matrix2d turn = radius / length * (Eigen::Matrix2d::Identity() - along * along.transpose());
      const Eigen::Vector2d trial_then = f - step * moved.segment<2>(m + 2 * c);
      A.middleRows<2>(t) = (turn * A.middleRows<2>(t)).eval();
      A.block<2, 2>(t, t) += (Eigen::Matrix2d::Identity() - turn) / step;
      A.block<2, 1>(t, i) -= mu[c] / step * along;
      residual.segment<2>(t) = (f - radius * along - turn * (trial_then - trial)) / step;
    }
    const Eigen::VectorXd d = A.partialPivLu().solve(residual);
    if (!d.allFinite()) return;
    x += change;
    for (Eigen::Index i = 0; i < 3 * k; ++i) x[entry[i]] -= d[i];
    // Inside the cones, as the law's residual wants them.
    Eigen::VectorXd inside = x;
    for (Eigen::Index c = 0; c < m; ++c) {
      inside[c] = std::max(inside[c], 0.0);
      const double length = inside.segment<2>(m + 2 * c).norm(), radius = mu[c] * inside[c];
      if (length > radius) inside.segment<2>(m + 2 * c) *= radius / length;
    }
    const double now = coulombResidual(D, w0, mu, inside);
    if (now < best) {
      best = now;
      r = inside;
    }
  }
}

// The iterate that has come closest to the law so far, of all methods.
struct Closest {
  double goal;
  Eigen::VectorXd r;
  double residual = std::numeric_limits<double>::infinity();

  bool arrived() const { return residual <= goal; }
  // Returns whether that is close enough.
  bool offer(const Eigen::VectorXd& candidate, double its_residual) {
    if (its_residual < residual) {
      r = candidate;
      residual = its_residual;
    }
    return arrived();
  }
};

void alternate(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, Eigen::VectorXd r,
               Closest& closest, FrictionReport& report) {
  const Eigen::Index m = mu.size();
  const bool frictionless = !(mu.maxCoeff() > 0.0);
  if (frictionless) r.tail(2 * m).setZero();
  double least = std::numeric_limits<double>::infinity();
  for (int it = 0; it < kMaximumAlternations; ++it) {
    ++report.iterations;
    Eigen::VectorXd lambda;
    const LcpReport lcp =
        solveLcp(D.topLeftCorner(m, m), w0.head(m) + D.topRightCorner(m, 2 * m) * r.tail(2 * m), lambda);
    if (!lcp.solved) return;
    r.head(m) = lambda;
    if (!frictionless) {
      Eigen::VectorXd f = r.tail(2 * m);
      // Its residual counts, not whether these sweeps have finished.
      static_cast<void>(solveDiscQp(D.bottomRightCorner(2 * m, 2 * m),
                                    w0.tail(2 * m) + D.bottomLeftCorner(2 * m, m) * lambda, mu.cwiseProduct(lambda),
                                    1e-14, kSweepsPerAlternation, f));
      r.tail(2 * m) = f;
    }
    const double residual = coulombResidual(D, w0, mu, r);
    if (closest.offer(r, residual)) return;
    // Worth a try whenever alternation has come clearly closer.
    if (residual > kCloser * least) continue;
    least = residual;
    Eigen::VectorXd candidate = r;
    newton(D, w0, mu, closest.goal, candidate, report);
    if (closest.offer(candidate, coulombResidual(D, w0, mu, candidate))) return;
  }
}

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

void sweep(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, Eigen::VectorXd r,
           Closest& closest, FrictionReport& report) {
  const Eigen::Index m = mu.size();
  report.staggered = false;
  Eigen::VectorXd w = D * r + w0;
  for (int it = 0; it < kMaximumSweeps; ++it) {
    ++report.iterations;
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
    if (closest.offer(r, coulombResidual(D, w0, mu, r))) return;
  }
}

}  // namespace

double coulombResidual(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu,
                       const Eigen::VectorXd& r) {
  const Eigen::Index m = mu.size();
  const Eigen::VectorXd w = D * r + w0;
  double worst = 0.0;
  for (Eigen::Index c = 0; c < m; ++c) {
    const double normal = normalStep(D, c), tangent = tangentStep(D, m, c);
    const double lambda = std::max(0.0, r[c] - normal * w[c]);
    worst = std::max(worst, std::abs(r[c] - lambda) / normal);
    const Eigen::Vector2d f = r.segment<2>(m + 2 * c);
    Eigen::Vector2d trial = f - tangent * w.segment<2>(m + 2 * c);
    const double length = trial.norm(), radius = mu[c] * r[c];
    if (length > radius) trial *= std::max(radius, 0.0) / length;
    worst = std::max(worst, (f - trial).norm() / tangent);
  }
  return worst;
}

FrictionReport solveFrictionalContact(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu,
                                      double tolerance, Eigen::VectorXd& r) {
  FrictionReport report;
  const Eigen::Index m = mu.size();
  if (r.size() != 3 * m) r = Eigen::VectorXd::Zero(3 * m);
  if (m == 0) {
    report.solved = true;
    return report;
  }
  const double scale = std::max(largest(w0), 1e-300);
  Closest closest{tolerance * scale, r};
  // A start that is nearly right, such as the last step's impulses, is only polished: where the law has more than one
  // answer, it stays with the nearest.
  newton(D, w0, mu, closest.goal, r, report);
  closest.offer(r, coulombResidual(D, w0, mu, r));
  if (!closest.arrived()) alternate(D, w0, mu, r, closest, report);
  if (!closest.arrived()) sweep(D, w0, mu, r, closest, report);
  r = closest.r;
  report.solved = closest.arrived();
  report.residual = closest.residual / scale;
  return report;
}

}  // namespace monolith
