#pragma once
// `reference`: the paper's own way. The stress system in (s, p) with the contacts' impulses behind it, symmetric
// positive semi-definite, by MPRGP with incomplete Cholesky; bodies enter as the sparse J, never as a dense block.
// Friction by staggered projections of two problems with the whole liquid in them: (s, p, lambda >= 0) with f given,
// and (s, p, f) with lambda given, |f_c| <= mu_c lambda_c. In the second (s, p) are free, so they are eliminated: f is
// found on the response of the bodies to impulses, and then solved for with the liquid until both agree. Where the
// alternation does not settle (redundant contacts, large mu: the share of each contact wanders) it gives way to
// Coulomb's law solved on that response, lambda and f at once, again with the liquid until both agree.
//
// The relative residual of that system says little when viscosity dominates, so the solve goes on until the residual of
// momentum and divergence, which is what the other solvers measure, meets the tolerance.

#include <memory>

#include "coupling/step_solver.h"

namespace monolith {

class ReferenceSolver : public StepSolver {
 public:
  ReferenceSolver();
  ~ReferenceSolver() override;
  void prepare(StepProblem& problem) override;
  [[nodiscard]] CoupledReport solve(StepVector& rhs, const CoupledOptions& options, StepVector& x) override;
  [[nodiscard]] CoupledReport solveWithContacts(StepVector& rhs, const ContactRows& contacts,
                                                const CoupledOptions& options, StepVector& x,
                                                Eigen::VectorXd& r) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace monolith
