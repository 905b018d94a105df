#include "solve/coulomb_newton.h"

#include <vector>

namespace monolith {
namespace {

constexpr int kMaximumSteps = 12;
constexpr int kPatience = 4;  // steps that come no closer

}  // namespace

int polishByNewton(const FrictionProblem& problem, const Eigen::VectorXd& r, ClosestToLaw& closest) {
  const auto& [D, w0, mu] = problem;
  const Eigen::Index m = problem.count();
  Eigen::VectorXd x = r;
  double least = coulombResidual(problem, r);
  int steps = 0, in_vain = 0;
  while (steps < kMaximumSteps && in_vain < kPatience && !closest.arrived()) {
    ++steps;
    const Eigen::VectorXd w = D * x + w0;
    // Contacts that do not press have no impulse; the others' rows are solved for.
    std::vector<Eigen::Index> pressing;
    for (Eigen::Index c = 0; c < m; ++c) {
      if (x[c] - problem.normalStep(c) * w[c] > 0.0) pressing.push_back(c);
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
      const double step = problem.tangentStep(c);
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
    if (!d.allFinite()) break;
    x += change;
    for (Eigen::Index i = 0; i < 3 * k; ++i) x[entry[i]] -= d[i];
    // Inside the cones, as the law's residual wants them.
    Eigen::VectorXd inside = x;
    for (Eigen::Index c = 0; c < m; ++c) {
      inside[c] = std::max(inside[c], 0.0);
      const double length = inside.segment<2>(m + 2 * c).norm(), radius = mu[c] * inside[c];
      if (length > radius) inside.segment<2>(m + 2 * c) *= radius / length;
    }
    double left;
    closest.offer(inside, &left);
    in_vain = left < least ? 0 : in_vain + 1;
    least = std::min(least, left);
  }
  return steps;
}

}  // namespace monolith
