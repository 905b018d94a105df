#include "solve/coulomb_newton.h"

#include <utility>
#include <vector>

#include "solve/contact_system.h"

namespace monolith {
namespace {

constexpr int kMaximumSteps = 20;
// Steps that come no closer: before it arrives it may be far off for many.
constexpr int kPatience = 10;

}  // namespace

int polishByNewton(const FrictionProblem& problem, const Eigen::VectorXd& r, ClosestToLaw& closest) {
  const Eigen::MatrixXd& D = problem.D;
  const Eigen::VectorXd &w0 = problem.w0, &mu = problem.mu;
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
    Eigen::VectorXd change = -x;
    for (const Eigen::Index c : pressing) {
      for (int d = 0; d < 3; ++d) change[problem.entry(c, d)] = 0.0;
    }
    const Eigen::VectorXd moved = w + D * change;
    std::vector<Eigen::Matrix3d> turns(pressing.size(), Eigen::Matrix3d::Identity());
    std::vector<Eigen::Matrix3d> own(pressing.size(), Eigen::Matrix3d::Zero());
    Eigen::VectorXd residual(3 * static_cast<Eigen::Index>(pressing.size()));
    for (std::size_t i = 0; i < pressing.size(); ++i) {
      const Eigen::Index c = pressing[i];
      auto here = residual.segment<3>(static_cast<Eigen::Index>(3 * i));
      here << moved[c], moved.segment<2>(m + 2 * c);
      const double step = problem.tangentStep(c);
      const Eigen::Vector2d f = x.segment<2>(m + 2 * c), trial = f - step * w.segment<2>(m + 2 * c);
      const double length = trial.norm(), radius = mu[c] * std::max(x[c], 0.0);
      if (length <= radius) continue;
      const Eigen::Vector2d along = trial / length;
      const Eigen::Matrix2d turn = radius / length * (Eigen::Matrix2d::Identity() - along * along.transpose());
      turns[i].bottomRightCorner<2, 2>() = turn;
      own[i].bottomRightCorner<2, 2>() = (Eigen::Matrix2d::Identity() - turn) / step;
      own[i].bottomLeftCorner<2, 1>() = -mu[c] / step * along;
      const Eigen::Vector2d trial_then = f - step * moved.segment<2>(m + 2 * c);
      here.tail<2>() = (f - radius * along - turn * (trial_then - trial)) / step;
    }
    const Eigen::VectorXd d = ContactSystem(problem, pressing, std::move(turns), std::move(own)).solve(residual);
    if (!d.allFinite()) break;
    x += change;
    for (std::size_t i = 0; i < pressing.size(); ++i) {
      for (int e = 0; e < 3; ++e) x[problem.entry(pressing[i], e)] -= d[static_cast<Eigen::Index>(3 * i) + e];
    }
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
