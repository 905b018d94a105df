#pragma once
// Coulomb's law contact by contact, block Gauss-Seidel (non-smooth contact dynamics: Jean 1999, Comput. Methods Appl.
// Mech. Eng. 177, 235). Slow where many contacts carry each other, but each contact's law is solved whatever its
// friction, with a search over all directions of slip: the last resort.

#include "solve/coulomb_law.h"

namespace monolith {

// From r; its iterates are offered. Returns the number of sweeps.
int sweepContacts(const FrictionProblem& problem, Eigen::VectorXd r, ClosestToLaw& closest);

}  // namespace monolith
