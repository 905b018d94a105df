#include "solve/mprgp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace monolith {
namespace {

constexpr double kProportioning = 1.0;  // Gamma
constexpr int kRefresh = 50;            // iterations after which the gradient is computed anew

// The gradient split as the method needs it: `free` where no bound is active, `chopped` where leaving an active one
// would decrease the objective.
struct Gradients {
  Eigen::VectorXd free, chopped;
};

void split(const Eigen::VectorXd& x, const Eigen::VectorXd& g, Eigen::Index unconstrained, Gradients& out) {
  out.free = g;
  out.chopped = Eigen::VectorXd::Zero(g.size());
  for (Eigen::Index i = unconstrained; i < x.size(); ++i) {
    if (x[i] > 0.0) continue;
    out.free[i] = 0.0;
    out.chopped[i] = std::min(g[i], 0.0);
  }
}

// Largest t for which x - t d stays feasible.
double feasibleStep(const Eigen::VectorXd& x, const Eigen::VectorXd& d, Eigen::Index unconstrained) {
  double t = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = unconstrained; i < x.size(); ++i) {
    if (d[i] > 0.0) t = std::min(t, x[i] / d[i]);
  }
  return t;
}

}  // namespace

MprgpReport solveMprgp(const VectorMap& apply, const VectorMap& precondition, double norm, const Eigen::VectorXd& b,
                       Eigen::Index unconstrained, const MprgpOptions& options, Eigen::VectorXd& x) {
  MprgpReport report;
  const Eigen::Index tail = x.size() - unconstrained;
  const auto makeFeasible = [&] { x.tail(tail) = x.tail(tail).cwiseMax(0.0); };
  const double goal = options.tolerance * b.norm();
  const double fixed_step = norm > 0.0 ? 1.0 / norm : 0.0;
  Eigen::VectorXd Ax, Ad, z;
  Gradients parts;
  const auto gradient = [&] {
    ++report.iterations;
    apply(x, Ax);
    return Eigen::VectorXd(Ax - b);
  };
  // Preconditioned free gradient: constrained entries as they are, in the scale of A.
  const auto face = [&] {
    Eigen::VectorXd out = parts.free * fixed_step;
    Eigen::VectorXd head = parts.free.head(unconstrained);
    Eigen::VectorXd answer;
    precondition(head, answer);
    out.head(unconstrained) = answer;
    return out;
  };
  makeFeasible();
  Eigen::VectorXd g = gradient();
  split(x, g, unconstrained, parts);
  z = face();
  Eigen::VectorXd p = z;
  int since_refresh = 0;
  while (report.iterations < options.maximum_iterations) {
    if (++since_refresh >= kRefresh) {
      g = gradient();
      split(x, g, unconstrained, parts);
      since_refresh = 0;
    }
    report.residual = (parts.free + parts.chopped).norm();
    if (report.residual <= goal) {
      if (since_refresh == 0) break;
      since_refresh = kRefresh;  // look again with a gradient that has no drift
      continue;
    }
    const double free_measure = z.dot(parts.free);
    const double chopped_measure = fixed_step * parts.chopped.squaredNorm();
    if (chopped_measure <= kProportioning * kProportioning * free_measure) {
      apply(p, Ad);
      ++report.iterations;
      const double curvature = p.dot(Ad);
      const double reach = feasibleStep(x, p, unconstrained);
      const double step = curvature > 0.0 ? g.dot(p) / curvature : reach;
      if (step <= reach && std::isfinite(step)) {
        x -= step * p;
        g -= step * Ad;
        split(x, g, unconstrained, parts);
        z = face();
        p = z - (z.dot(Ad) / curvature) * p;
      } else {
        if (std::isfinite(reach)) {
          x -= reach * p;
          g -= reach * Ad;
        }
        // Expansion: of the constrained entries only; their number is small and the others need no constraint found.
        makeFeasible();
        split(x, g, unconstrained, parts);
        x.tail(tail) -= fixed_step * parts.free.tail(tail);
        makeFeasible();
        g = gradient();
        since_refresh = 0;
        split(x, g, unconstrained, parts);
        z = face();
        p = z;
      }
    } else {
      const Eigen::VectorXd& d = parts.chopped;
      apply(d, Ad);
      ++report.iterations;
      const double curvature = d.dot(Ad);
      const double step = curvature > 0.0 ? g.dot(d) / curvature : fixed_step;
      x -= step * d;
      makeFeasible();
      g = gradient();
      since_refresh = 0;
      split(x, g, unconstrained, parts);
      z = face();
      p = z;
    }
  }
  g = gradient();
  split(x, g, unconstrained, parts);
  const double b_norm = b.norm();
  report.residual = (parts.free + parts.chopped).norm() / (b_norm > 0.0 ? b_norm : 1.0);
  report.converged = report.residual <= 1.01 * options.tolerance;
  return report;
}

}  // namespace monolith
