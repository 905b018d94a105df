#pragma once
// Newton's method on Coulomb's law, r = P(r - w/D_cc) (Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92, 353):
// undamped, it polishes what is nearly right, though on its way it may be far off.

#include "solve/coulomb_law.h"

namespace monolith {

// From r; its iterates are offered. Returns the number of steps.
int polishByNewton(const FrictionProblem& problem, const Eigen::VectorXd& r, ClosestToLaw& closest);

}  // namespace monolith
