#pragma once
// A step that is implicit in the viscosity: velocities u and viscosities eta with
//   A(eta) u = b   and   eta = law(gamma(u)),
// by fixed-point iteration around the coupled solve (contact included), which for a liquid that thins lowers the step's
// convex energy each time (Kachanov's method: Han, Jensen & Shimansky 1997, Numer. Math. 76, 1), accelerated by
// Anderson's method on ln eta. It has converged when the residual of both together, |b - A(law(u)) u|/|b|, is below
// the solver's tolerance.

#include <functional>

#include "coupling/coupled_system.h"
#include "fluid/rheology.h"
#include "scene/scene.h"

namespace monolith {

ViscosityLaw makeViscosityLaw(const LiquidDescription& liquid);

struct RheologyReport {
  int iterations = 0;
  double residual = 0.0;           // what following the viscosity leaves of the step's equations, relative
  double typical_viscosity = 0.0;  // Pa s, geometric mean over the liquid: the next step's reference
};

// One coupled solve with the options given; its guess and its result are the state of the iteration.
using CoupledSolve = std::function<CoupledReport(const CoupledOptions&)>;

// The system has been assembled with assembleVariable() and `reference`. options.tolerance: of the linear solves in
// the end; tolerance: of the viscosity.
[[nodiscard]] CoupledReport solveNonNewtonian(CoupledSystem& system, const ViscosityLaw& law, double reference,
                                              int maximum_iterations, double tolerance, const CoupledOptions& options,
                                              const CoupledSolve& solve, const CoupledState& state,
                                              RheologyReport& rheology);

}  // namespace monolith
