#pragma once
// What each contact of a step does - open, sticks, slips - as rows and columns that border the linear system.

#include <Eigen/Dense>
#include <vector>

#include "coupling/contact_rows.h"

namespace monolith {

enum class ContactState { kOpen, kStick, kSlip };

struct ContactStates {
  std::vector<ContactState> state;
  // Of contacts that slip: 2m, direction of friction d; m, speed of slip over friction's impulse, 0 without friction.
  Eigen::VectorXd direction, mobility;
};

// All contacts open.
ContactStates openStates(const ContactRows& contacts);

// From impulses r that obey Coulomb's law with the velocities w = D r + w0. Both decide: an impulse of round-off at a
// contact that is opening does not press.
ContactStates contactStates(const ContactRows& contacts, const Eigen::MatrixXd& D, const Eigen::VectorXd& w,
                            const Eigen::VectorXd& r);

// Unknown impulses y of the contacts that press: R v + bias + mobility y = 0, forces C y on the bodies. Coulomb's law
// linearised: a contact that slips pushes along n + mu d, and across d as much as the slip's turning asks for, which
// is against the slip to first order.
struct ContactBorder {
  Eigen::MatrixXd R;                // k x 6n
  Eigen::MatrixXd C;                // 6n x k
  Eigen::VectorXd bias, mobility;   // k
  std::vector<Eigen::Index> entry;  // place of y_i in the impulses r; across d the first of the contact's tangents

  Eigen::Index count() const { return bias.size(); }
};

ContactBorder makeBorder(const ContactRows& contacts, const ContactStates& states);

// r from y.
Eigen::VectorXd impulses(const ContactRows& contacts, const ContactStates& states, const ContactBorder& border,
                         const Eigen::VectorXd& y);
// y from r.
Eigen::VectorXd borderUnknowns(const ContactRows& contacts, const ContactStates& states, const ContactBorder& border,
                               const Eigen::VectorXd& r);

}  // namespace monolith
