#include "coupling/iterative_coupling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "solve/anderson.h"
#include "solve/frictional_contact.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 500;
// Coulomb's law on the bodies alone is solved this much more closely than the whole, as far as digits allow.
constexpr double kSmallFactor = 0.01;
constexpr double kSmallTolerance = 1e-9;
constexpr int kHistory = 8;  // of the acceleration: plain alternation contracts by the liquid's share of the
                             // resistance, which is nearly one for light bodies and thick liquids
// Growth of the change, after which the history is dropped: where contacts change what they do the map has a kink, and
// what was learnt on its other side misleads.
constexpr double kGrowth = 2.0;

}  // namespace

CoupledReport solveIteratively(StepSolver& solver, const StepProblem& problem, const StepVector& rhs,
                               const ContactRows& contacts, const CoupledOptions& options, StepVector& x,
                               Eigen::VectorXd& r) {
  const Eigen::Index n = problem.bodyUnknowns();
  const Eigen::MatrixXd M = problem.bodyInertia(), K = M.inverse();
  const BodyCoordinates& unknowns = problem.coordinates;
  Eigen::VectorXd compliance;
  const Eigen::MatrixXd D = contactResponse(contacts, K, compliance);
  if (r.size() != 3 * contacts.count()) r = Eigen::VectorXd::Zero(3 * contacts.count());
  CoupledReport report;
  StepVector pushed = rhs;
  double change = 0.0;
  const double small_tolerance = std::max(kSmallFactor * options.tolerance, kSmallTolerance);
  Anderson anderson(kHistory, 1.0);
  const std::vector<double> equal(static_cast<std::size_t>(n), 1.0);
  double least = std::numeric_limits<double>::infinity();
  Eigen::VectorXd push = contacts.J.transpose() * r;
  for (int it = 0; it < kMaximumAlternations; ++it) {
    // Pressure, viscosity and bodies.
    unknowns.scatterForces(unknowns.gatherForces(rhs.bodies) + push, pushed.bodies);
    const CoupledReport liquid = solver.solve(pushed, options, x);
    report.iterations += liquid.iterations;
    report.solves += liquid.solves;
    report.residual = liquid.residual;
    if (liquid.status != SolveStatus::kConverged) {
      report.status = liquid.status;
      report.message = liquid.message;
      return report;
    }
    // Contact alone: what the bodies would do under the liquid's forces just found.
    const Eigen::VectorXd v = unknowns.gatherMotion(x.bodies);
    const Eigen::VectorXd w = contacts.J * (v - K * push) + contacts.bias;
    const FrictionReport friction = solveFrictionalContact({D, w, contacts.friction}, small_tolerance, r);
    report.friction_iterations += 1;
    report.contact_residual = friction.residual;
    const Eigen::VectorXd next = contacts.J.transpose() * r;
    const double size = std::max({next.dot(K * next), push.dot(K * push), v.dot(M * v), 1e-300});
    change = std::sqrt((next - push).dot(K * (next - push)) / size);
    if (friction.acceptable() && change <= options.tolerance) {
      report.status = SolveStatus::kConverged;
      return report;
    }
    const double moved = (next - push).norm();
    if (moved > kGrowth * least) {
      anderson.forget();
      least = moved;
    }
    least = std::min(least, moved);
    std::vector<double> mixed(push.begin(), push.end());
    anderson.advance({next.begin(), next.end()}, equal, mixed);
    push = Eigen::Map<const Eigen::VectorXd>(mixed.data(), n);
  }
  std::ostringstream text;
  text << "pressure and contact did not agree after " << kMaximumAlternations
       << " alternations: the impulses still change by " << change;
  report.status = SolveStatus::kNotConverged;
  report.message = text.str();
  return report;
}

}  // namespace monolith
