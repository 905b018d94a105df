#pragma once
// Rows of the contacts over the unknowns of the bodies' motion: velocity at contact c = J_c q + bias_c, one normal row
// and two tangential ones. The end of a joint's range is a contact without friction, its tangents are none, behind
// those of the bodies. J = (J_n; J_t) with the m normal rows first, then two tangential ones per contact; impulses r =
// (lambda; f) are ordered likewise, in the units of coupling/stokes_coefficients.h.

#include <Eigen/Dense>
#include <vector>

#include "coupling/step_problem.h"
#include "rigid/articulation.h"
#include "rigid/contact.h"

namespace monolith {

// How a pair of surfaces meets.
struct ContactLaw {
  double friction = 0.0;     // Coulomb coefficient
  double restitution = 0.0;  // speed of separation over speed of approach, of impacts
};

// What a contact did in the last step, mean over it; contacts of the next one start from it.
struct ContactForce {
  Contact contact;
  double normal = 0.0;                                 // N
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();  // N, on body_a, in W
};

// Likewise the end of a joint's range.
struct StopForce {
  int body = 0;
  double sign = 1.0;
  double effort = 0.0;  // N m, N, along sign
};

struct ContactRows {
  Eigen::MatrixXd J;         // 3m x unknowns
  Eigen::VectorXd bias;      // 3m, m/s; normal: non-penetration is (J q + bias)_n >= 0
  Eigen::VectorXd friction;  // m
  Eigen::VectorXd softness;  // 3m, of its compliance (step_solver.h): 1, more where a body moves as prescribed
  std::vector<Eigen::Matrix<double, 3, 2>> tangents;
  std::vector<JointStop> stops;  // those of the contacts behind those of bodies
  std::vector<int> pair;     // m: contacts of the same two bodies have the same number, from 0 on

  Eigen::Index count() const { return friction.size(); }
};

// After the right side, of which it takes what is prescribed. `laws`: one per contact. resting_speed, m/s: a slower
// approach is no impact.
ContactRows buildContactRows(const StepProblem& problem, const std::vector<Contact>& contacts,
                             const std::vector<ContactLaw>& laws, const std::vector<JointStop>& stops,
                             double resting_speed);

// What they did, mean over the step.
struct ContactForces {
  std::vector<ContactForce> contacts;
  std::vector<StopForce> stops;
};

// r from the forces of the last step: those of the same bodies at about the same place in about the same direction, and
// of the same ends of joints.
Eigen::VectorXd warmStart(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                          const ContactForces& last);

// The forces of the impulses r, and the wrenches that contacts exert.
void distributeImpulses(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                        const Eigen::VectorXd& r, ContactForces& forces, std::vector<Wrench>& wrenches);

}  // namespace monolith
