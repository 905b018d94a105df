#pragma once
// `fast`: flexible GMRES on the saddle point, matrix-free, with the projection preconditioner (Griffith 2009; Cai,
// Nonaka, Bell, Griffith & Donev 2014): one multigrid cycle on A_uu, one on L = C K C^T with p^ = phi + 2 N g
// (Cahouet & Chabard 1988), and the bodies by an approximate Schur complement S, their inertia and their resistance to
// motion in this liquid, which ages slowly and is kept while it serves.
//
// Contacts that press are rows of the same system: the normal velocity of each, the tangential velocity of those that
// stick; a contact that slips pushes along (n + mu d) lambda with a direction d opposite to its slip, and across d as
// the slip turns: Coulomb's law linearised. What each contact does is found (solve/frictional_contact.h) on J S^-1 J^T
// (contact_guess.h) and verified on the full solution, until the law holds there: Newton's method, which needs one
// solve with the liquid where contacts go on as they did, else two or three. Those that are not the last are rough.

#include <memory>

#include "coupling/step_solver.h"

namespace monolith {

class FastSolver : public StepSolver {
 public:
  FastSolver();
  ~FastSolver() override;
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
