#include "simulation/non_newtonian.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "solve/anderson.h"

namespace monolith {
namespace {

constexpr int kDepth = 10;              // iterates that the acceleration looks back on
constexpr double kFirstForcing = 1e-2;  // relative residual of the first linear solve
constexpr double kForcing = 0.02;       // ... of the others, relative to what the viscosity left before
// Round-off of a solve in which viscosities differ by orders of magnitude: no residual below it is asked for.
constexpr double kLeastGoal = 1e-9;
constexpr double kGrowth = 1.5;  // of the residual over its least so far: the acceleration has gone astray

// Extrapolation knows no limits; the law does.
void clampField(const ViscosityLaw& law, double reference, ViscosityField& field) {
  const double least = std::log(law.least() / reference);
  const double most = std::log(law.most() / reference);
  for (double& value : field.log_ratio) {
    // No sample has no weight and stays at exactly zero.
    if (value != 0.0) value = std::clamp(value, least, most);
  }
}

}  // namespace

ViscosityLaw makeViscosityLaw(const LiquidDescription& liquid) {
  const RheologyDescription& r = liquid.rheology;
  switch (r.law) {
    case RheologyDescription::Law::kPowerLaw:
      return ViscosityLaw::powerLaw(r.consistency, r.index, r.minimum_viscosity, r.maximum_viscosity);
    case RheologyDescription::Law::kCarreauYasuda:
      return ViscosityLaw::carreauYasuda(r.zero_shear_viscosity, r.infinite_shear_viscosity, r.time_constant, r.index,
                                         r.transition);
    case RheologyDescription::Law::kHerschelBulkley: {
      const double bingham_most = r.consistency + r.regularisation * r.yield_stress;
      return ViscosityLaw::herschelBulkley(r.yield_stress, r.consistency, r.index, r.regularisation,
                                           r.minimum_viscosity > 0.0 ? r.minimum_viscosity : r.consistency,
                                           r.maximum_viscosity > 0.0 ? r.maximum_viscosity : bingham_most);
    }
    case RheologyDescription::Law::kNewtonian:
      break;
  }
  return ViscosityLaw::newtonian(liquid.dynamic_viscosity);
}

CoupledReport solveNonNewtonian(CoupledSystem& system, const ViscosityLaw& law, double reference,
                                int maximum_iterations, double tolerance, const CoupledOptions& options,
                                const CoupledSolve& solve, const CoupledState& state, RheologyReport& rheology) {
  ViscosityField now, next;
  system.evaluateViscosity(law, state, now);
  // What damping by the steepest slope does not cure is left to the acceleration.
  Anderson anderson(kDepth, 1.0 / law.steepest());
  CoupledOptions inner = options;
  const double linear_goal = std::max(0.5 * options.tolerance, kLeastGoal);
  inner.tolerance = std::max(linear_goal, kFirstForcing);
  CoupledReport total;
  double least = 0.0;
  bool extrapolated = false;  // the viscosities, beyond those of a solution
  rheology = RheologyReport();
  while (rheology.iterations < maximum_iterations) {
    ++rheology.iterations;
    system.setViscosity(now);
    const CoupledReport solved = solve(inner);
    total.iterations += solved.iterations;
    total.solves += solved.solves;
    total.friction_iterations += solved.friction_iterations;
    total.status = solved.status;
    total.message = solved.message;
    total.residual = solved.residual;
    total.contact_residual = solved.contact_residual;
    total.divergence = solved.divergence;
    if (solved.status == SolveStatus::kNotConverged && extrapolated) {
      // The acceleration has led to viscosities that are too hard to solve for: on from those of the last solution.
      now = next;
      anderson.forget();
      extrapolated = false;
      continue;
    }
    if (solved.status != SolveStatus::kConverged) return total;

    system.evaluateViscosity(law, state, next);
    rheology.residual = system.viscousChange(state, next);
    rheology.typical_viscosity = reference * std::exp(next.mean_log);
    if (rheology.residual <= 0.5 * tolerance && inner.tolerance <= linear_goal) return total;
    inner.tolerance = std::max(linear_goal, std::min(kForcing * rheology.residual, kFirstForcing));
    if (rheology.residual <= 0.5 * tolerance) inner.tolerance = linear_goal;
    if (rheology.iterations == 1 || rheology.residual < least) least = rheology.residual;
    if (rheology.residual > kGrowth * least) {
      anderson.forget();
      least = rheology.residual;
    }
    anderson.advance(next.log_ratio, next.weight, now.log_ratio);
    extrapolated = true;
    clampField(law, reference, now);
  }
  std::ostringstream text;
  text << "the viscosity did not settle in " << maximum_iterations << " iterations: relative residual "
       << rheology.residual << ", wanted " << 0.5 * tolerance;
  total.status = SolveStatus::kNotConverged;
  total.message = text.str();
  return total;
}

}  // namespace monolith
