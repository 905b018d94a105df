#pragma once
// What each contact of a step does - open, sticks, slips - as rows and columns that border the linear system.

#include <Eigen/Dense>
#include <vector>

#include "coupling/contact_rows.h"

namespace monolith {

enum class ContactState { kOpen, kStick, kSlip };

struct ContactStates {
  std::vector<ContactState> state;
  Eigen::VectorXd direction;  // 2m: of friction over mu lambda, of contacts that slip
};

// All contacts open.
ContactStates openStates(const ContactRows& contacts);

// From impulses r that obey Coulomb's law with the velocities w = D r + w0. Both decide: an impulse of round-off at a
// contact that is opening does not press.
ContactStates contactStates(const ContactRows& contacts, const Eigen::MatrixXd& D, const Eigen::VectorXd& w,
                            const Eigen::VectorXd& r);

// Unknown impulses y of the contacts that press: velocity rows R v, forces C y on the bodies.
struct ContactBorder {
  Eigen::MatrixXd R;                // k x 6n
  Eigen::MatrixXd C;                // 6n x k
  Eigen::VectorXd bias;             // k
  std::vector<Eigen::Index> entry;  // place of y_i in the impulses r

  Eigen::Index count() const { return bias.size(); }
};

ContactBorder makeBorder(const ContactRows& contacts, const ContactStates& states);

// r from y: friction of slipping contacts follows their normal impulse.
Eigen::VectorXd impulses(const ContactRows& contacts, const ContactStates& states, const ContactBorder& border,
                         const Eigen::VectorXd& y);
// y from r.
Eigen::VectorXd borderUnknowns(const ContactBorder& border, const Eigen::VectorXd& r);

}  // namespace monolith
