#pragma once
// What the solvers of a step (step_problem.h) have in common: `fast`, `direct` and `reference` answer the same two
// questions. x holds the twists of all bodies but for what prescribed motions bring to them; those that are not free
// are left alone and count as zero (their motion is in the right side already).

#include <string>

#include "coupling/contact_rows.h"
#include "coupling/solve_status.h"
#include "coupling/step_problem.h"

namespace monolith {

struct CoupledOptions {
  double tolerance = 1e-6;       // |b - A x|_2 relative to |b|_2
  int maximum_iterations = 200;  // Krylov iterations of one linear solve of `fast`
  int maximum_rounds = 30;       // solves of `fast` until the contacts have settled
};

struct CoupledReport {
  SolveStatus status = SolveStatus::kNotRun;
  std::string message;
  int iterations = 0;             // of the linear solver; `direct`: none
  int solves = 0;                 // with the whole liquid
  int friction_iterations = 0;    // of Coulomb's law on the small system, or rounds between pressure and contact
  double residual = 0.0;          // relative, recomputed
  double contact_residual = 0.0;  // of Coulomb's law, relative to the speeds that contacts change
  double divergence = 0.0;        // 1/s, largest over cells with pressure
};

class StepSolver {
 public:
  virtual ~StepSolver() = default;
  // The problem must outlive its use; called again whenever it has been assembled anew.
  virtual void prepare(StepProblem& problem) = 0;
  // operator * x = rhs, without contact. x: guess on entry, solution if the report says so. rhs is on return what it
  // was, and may be written to in between.
  [[nodiscard]] virtual CoupledReport solve(StepVector& rhs, const CoupledOptions& options, StepVector& x) = 0;
  // With contacts, unified: pressure, viscosity, bodies, non-penetration and friction. r: start on entry, impulses on
  // return.
  [[nodiscard]] virtual CoupledReport solveWithContacts(StepVector& rhs, const ContactRows& contacts,
                                                        const CoupledOptions& options, StepVector& x,
                                                        Eigen::VectorXd& r) = 0;
};

// Compliance of contacts relative to that of their bodies: keeps redundant contacts (four corners of a box) solvable
// and unique, at a speed far below any tolerance. The same for all contacts of a pair, so that every solver shares a
// load among them in the same way. Times their softness.
constexpr double kContactCompliance = 1e-9;
void addCompliance(const ContactRows& contacts, Eigen::MatrixXd& response, Eigen::VectorXd& compliance);

// J K J^T with that compliance added to its diagonal; `compliance` returns it. K: response of the bodies' unknowns
// to impulses on them.
Eigen::MatrixXd contactResponse(const ContactRows& contacts, const Eigen::MatrixXd& K, Eigen::VectorXd& compliance);

// |r| over velocities, pressures and, in the scale of their inertia, bodies.
double stepNorm(const StepProblem& problem, const StepVector& r);
// The bodies' part of it, of impulses on their unknowns.
double bodiesNorm(const StepProblem& problem, const Eigen::VectorXd& impulses);
// residual = rhs - operator * x.
void stepResidual(const StepProblem& problem, const StepVector& rhs, const StepVector& x, StepVector& residual);
// Its norm relative to that of the right side: 0 of one that is zero, not a number of one that is none.
double relativeNorm(const StepProblem& problem, const StepVector& residual, const StepVector& rhs);

}  // namespace monolith
