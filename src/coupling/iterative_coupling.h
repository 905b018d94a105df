#pragma once
// The coupling `iterative`, for comparison with the unified one: pressure and viscosity with the bodies, contact
// impulses given, in turn with contact alone, the liquid's forces given, until the impulses on the bodies no longer
// change. Any step solver does the first part. Agrees with the unified coupling when it converges (the paper's
// supplement, section 4); slowly where the liquid resists a body much more than its own inertia.

#include "coupling/step_solver.h"

namespace monolith {

[[nodiscard]] CoupledReport solveIteratively(StepSolver& solver, const StepProblem& problem, const StepVector& rhs,
                                             const ContactRows& contacts, const CoupledOptions& options, StepVector& x,
                                             Eigen::VectorXd& r);

}  // namespace monolith
