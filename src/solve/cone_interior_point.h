#pragma once
// Coulomb's law as a complementarity problem of second-order cones, by an interior point method.
//
// With x = (mu lambda, f) and z = (w_n/mu + |w_t|, w_t) the law at a contact is x in L, z in L, x . z = 0, where
// L = {x: |x_1..2| <= x_0} (de Saxce & Feng 1998, Math. Comput. Modelling 28, 225): but for |w_t| the optimality of a
// convex quadratic program (Acary, Cadoux, Lemarechal & Malick 2011, ZAMM 91, 155). Primal-dual steps with the scaling
// of Nesterov & Todd (1997, Math. Oper. Res. 22, 1) and Mehrotra's predictor and corrector (1992, SIAM J. Optim. 2,
// 575), formulae as in Vandenberghe (2010, The CVXOPT linear and quadratic cone program solvers). The derivative of
// |w_t| is in the step's matrix near the solution; farther off, and where such a step gets nowhere, |w_t| is held at
// what it is, which is slower and fails less often. Where neither leads to the law, each is tried alone.
//
// A load that redundant contacts share is spread over all of them in a few dozen factorisations, where alternating and
// sweeping pass it on and on.

#include "solve/coulomb_law.h"

namespace monolith {

// Offers its iterates, which are inside the cones, and what Newton's method makes of the best. Returns the number of
// steps of both.
int findInteriorPoint(const FrictionProblem& problem, ClosestToLaw& closest);

}  // namespace monolith
