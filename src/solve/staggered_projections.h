#pragma once
// Staggered projections (Kaufman, Sueda, James & Pai 2008, ACM TOG 27(5)): the two problems
//   normal problem, f given:         0 <= lambda, 0 <= w_n, lambda . w_n = 0
//   friction problem, lambda given:  min over |f_c| <= mu_c lambda_c of 1/2 f^T D_tt f + (D_tn lambda + w0_t)^T f
// alternated to a fixed point, at which each contact obeys Coulomb's law. Fast where few contacts share a load; with
// many it contracts slowly, and not at all where large mu meets a strong coupling of normal and tangent.

#include "solve/coulomb_law.h"

namespace monolith {

// From r; its iterates, and what Newton's method makes of the best, are offered. Returns the number of alternations and
// Newton steps.
int alternateProjections(const FrictionProblem& problem, Eigen::VectorXd r, ClosestToLaw& closest);

}  // namespace monolith
