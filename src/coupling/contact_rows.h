#pragma once
// Rows of the contacts over the twists of the free bodies: velocity at contact c = J_c v + bias_c, one normal row and
// two tangential ones. J = (J_n; J_t) with the m normal rows first, then two tangential ones per contact; impulses r =
// (lambda; f) are ordered likewise, in the units of coupling/stokes_coefficients.h.

#include <Eigen/Dense>
#include <vector>

#include "coupling/step_problem.h"
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

struct ContactRows {
  Eigen::MatrixXd J;         // 3m x 6n
  Eigen::VectorXd bias;      // 3m, m/s; normal: non-penetration is (J v + bias)_n >= 0
  Eigen::VectorXd friction;  // m
  Eigen::VectorXd softness;  // 3m, of its compliance (step_solver.h): 1, more where a body moves as prescribed
  std::vector<Eigen::Matrix<double, 3, 2>> tangents;
  std::vector<int> pair;     // m: contacts of the same two bodies have the same number, from 0 on

  Eigen::Index count() const { return friction.size(); }
};

// `twists`: of the bodies that are not free. `laws`: one per contact. resting_speed, m/s: a slower approach is no
// impact.
ContactRows buildContactRows(const StepProblem& problem, const std::vector<Contact>& contacts,
                             const std::vector<ContactLaw>& laws, const std::vector<Vector6d>& twists,
                             double resting_speed);

// r from the forces of the last step: those of the same bodies at about the same place in about the same direction.
Eigen::VectorXd warmStart(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                          const std::vector<ContactForce>& last);

// The forces of the impulses r, with their contacts, and the wrenches that they exert; means over the step.
void distributeImpulses(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                        const Eigen::VectorXd& r, std::vector<ContactForce>& forces, std::vector<Wrench>& wrenches);

}  // namespace monolith
