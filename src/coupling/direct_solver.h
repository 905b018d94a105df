#pragma once
// `direct`: the stress system A (coupling/stress_system.h) is factored by CHOLMOD, the bodies and the constants of
// sealed regions are eliminated exactly on top of it,
//   x = A^-1 (c + J v),   S v = f_v - J^T A^-1 c + J_c^T r,   S = M_S + J^T A^-1 J,
// and the contacts on S^-1: the Schur complement A_33 - A_23^T A_22^-1 A_23 of the paper's supplement, section 4, as a
// small dense problem. Exact up to round-off; memory and time grow like those of a 3-D factorisation.

#include <memory>

#include "coupling/step_solver.h"

namespace monolith {

class DirectSolver : public StepSolver {
 public:
  DirectSolver();
  ~DirectSolver() override;
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
