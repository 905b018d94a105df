#include "solve/staggered_projections.h"

#include <limits>

#include "solve/coulomb_newton.h"
#include "solve/disc_qp.h"
#include "solve/lcp.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 100;
constexpr int kPatience = 10;              // alternations that come no closer by kCloser
constexpr int kSweepsPerAlternation = 50;  // of the friction problem, which need not be solved closely
constexpr double kCloser = 0.5;

}  // namespace

int alternateProjections(const FrictionProblem& problem, Eigen::VectorXd r, ClosestToLaw& closest) {
  const Eigen::MatrixXd& D = problem.D;
  const Eigen::VectorXd &w0 = problem.w0, &mu = problem.mu;
  const Eigen::Index m = problem.count();
  const bool frictionless = !(mu.maxCoeff() > 0.0);
  if (frictionless) r.tail(2 * m).setZero();
  const DiscQp qp(D.bottomRightCorner(2 * m, 2 * m));
  double least = std::numeric_limits<double>::infinity();
  int iterations = 0, in_vain = 0;
  for (int it = 0; it < kMaximumAlternations && in_vain < kPatience; ++it) {
    ++iterations;
    Eigen::VectorXd lambda;
    const LcpReport lcp =
        solveLcp(D.topLeftCorner(m, m), w0.head(m) + D.topRightCorner(m, 2 * m) * r.tail(2 * m), lambda);
    if (!lcp.solved) break;
    r.head(m) = lambda;
    if (!frictionless) {
      Eigen::VectorXd f = r.tail(2 * m);
      // Its residual counts, not whether these sweeps have finished.
      static_cast<void>(qp.solve(w0.tail(2 * m) + D.bottomLeftCorner(2 * m, m) * lambda, mu.cwiseProduct(lambda), 1e-14,
                                 kSweepsPerAlternation, f));
      r.tail(2 * m) = f;
    }
    double residual;
    if (closest.offer(r, &residual)) break;
    // Worth a try whenever alternation has come clearly closer.
    ++in_vain;
    if (residual > kCloser * least) continue;
    least = residual;
    in_vain = 0;
    iterations += polishByNewton(problem, r, closest);
    if (closest.arrived()) break;
  }
  return iterations;
}

}  // namespace monolith
