#pragma once
// What the contacts of a step do, as far as is known while `fast` solves it: impulses r and states by Coulomb's law on
// a small system, w = D r + w0 at the contacts with D = J K J^T, whose response K of the bodies to impulses is an
// estimate that learns from the solutions. Each solution with the liquid shifts w0, and so corrects it.

#include <Eigen/Dense>

#include "coupling/contact_states.h"
#include "coupling/step_solver.h"
#include "solve/frictional_contact.h"

namespace monolith {

class ContactGuess {
 public:
  // Rows and impulses (start on entry, those of the guess from then on) must outlive it. tolerance: of the whole solve.
  ContactGuess(const ContactRows& rows, Eigen::VectorXd& impulses, double tolerance);

  // Change of the contacts, relative to their speeds, up to which they have settled.
  static double settledAt(double tolerance);

  const ContactStates& states() const { return states_; }
  const Eigen::VectorXd& compliance() const { return bodies_.compliance; }  // of each contact row
  Eigen::VectorXd push() const { return rows_.J.transpose() * r_; }   // on the bodies

  void setResponse(const Eigen::MatrixXd& K);
  void setImpulses(const Eigen::VectorXd& r) { r_ = r; }
  // None presses.
  void setOpen();

  // What the contacts do where the bodies would move with these twists without them. rough: twists and response are.
  void startFrom(const Eigen::VectorXd& twists, bool rough, CoupledReport& report);

  // Of a solution with the present impulses; error: its own, relative.
  void learnFrom(const Eigen::VectorXd& twists, double error);

  struct Change {
    bool settled = false;   // no body would move otherwise: the impulses obey Coulomb's law
    double relative = 0.0;  // to the speeds at the contacts
  };
  // What the contacts do next after this solution. rough: another one follows in any case.
  Change proceedFrom(const Eigen::VectorXd& twists, bool rough, CoupledReport& report);

 private:
  Eigen::VectorXd velocities(const Eigen::VectorXd& twists) const { return rows_.J * twists + rows_.bias; }
  double closeness(bool rough) const;
  void update(const Eigen::VectorXd& dg, const Eigen::VectorXd& dv);
  // Their law, solved from r on.
  FrictionReport solveLaw(const Eigen::VectorXd& w0, bool rough, Eigen::VectorXd& r) const;

  const ContactRows& rows_;
  Eigen::VectorXd& r_;
  double tolerance_;
  BodyResponse bodies_;  // its inverse only where it serves and there is one
  Eigen::MatrixXd D_;
  ContactStates states_;
  Eigen::VectorXd last_push_, last_twists_;
};

}  // namespace monolith
