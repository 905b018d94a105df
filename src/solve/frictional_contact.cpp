#include "solve/frictional_contact.h"

#include "solve/cone_interior_point.h"
#include "solve/contact_sweeps.h"
#include "solve/coulomb_newton.h"
#include "solve/staggered_projections.h"

namespace monolith {

FrictionReport solveFrictionalContact(const FrictionProblem& problem, double tolerance, Eigen::VectorXd& r) {
  FrictionReport report;
  const Eigen::Index m = problem.count();
  if (r.size() != 3 * m) r = Eigen::VectorXd::Zero(3 * m);
  if (m == 0) {
    report.solved = true;
    return report;
  }
  const double scale = std::max(problem.w0.cwiseAbs().maxCoeff(), 1e-300);
  ClosestToLaw closest(problem, tolerance * scale);
  closest.offer(r);
  if (!closest.arrived()) report.iterations += polishByNewton(problem, r, closest);
  if (!closest.arrived()) report.iterations += alternateProjections(problem, closest.impulses(), closest);
  if (!closest.arrived()) report.iterations += findInteriorPoint(problem, closest);
  if (closest.residual() > kAcceptableLaw * scale) {
    report.iterations += sweepContacts(problem, closest.impulses(), closest);
  }
  r = closest.impulses();
  report.solved = closest.arrived();
  report.residual = closest.residual() / scale;
  return report;
}

}  // namespace monolith
