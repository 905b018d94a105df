#include "solve/coulomb_law.h"

#include <cmath>

namespace monolith {

double coulombResidual(const FrictionProblem& problem, const Eigen::VectorXd& r) {
  const Eigen::Index m = problem.count();
  const Eigen::VectorXd w = problem.D * r + problem.w0;
  double worst = 0.0;
  for (Eigen::Index c = 0; c < m; ++c) {
    const double normal = problem.normalStep(c), tangent = problem.tangentStep(c);
    const double lambda = std::max(0.0, r[c] - normal * w[c]);
    worst = std::max(worst, std::abs(r[c] - lambda) / normal);
    const Eigen::Vector2d f = r.segment<2>(m + 2 * c);
    Eigen::Vector2d trial = f - tangent * w.segment<2>(m + 2 * c);
    const double length = trial.norm(), radius = problem.mu[c] * r[c];
    if (length > radius) trial *= std::max(radius, 0.0) / length;
    worst = std::max(worst, (f - trial).norm() / tangent);
  }
  return worst;
}

bool ClosestToLaw::offer(const Eigen::VectorXd& candidate, double* its_residual) {
  const double residual = coulombResidual(problem_, candidate);
  if (its_residual != nullptr) *its_residual = residual;
  if (residual < residual_) {
    r_ = candidate;
    residual_ = residual;
  }
  return residual <= goal_;
}

}  // namespace monolith
