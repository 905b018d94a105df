// Contacts of a step start from what they did in the one before.

#include "coupling/contact_rows.h"

#include <gtest/gtest.h>

#include "scene/solid_body.h"

namespace monolith {
namespace {

struct Corner {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  StepProblem problem;
  std::vector<Contact> contacts;

  Corner() : problem(oneCell(), Discretisation::kFitted) {
    bodies.push_back(makeRigidBody(boxBody("box", {0.2, 0.2, 0.2}, 1000.0, {0.1, 0.1, 0.1}), 0.02));
    problem.grid.h = 0.02;
    problem.bodies = &bodies;
    problem.free = problem.free_index = {0};
    problem.given = {Vector6d::Zero()};
    problem.coordinates.set(bodies);
    problem.impulse_scale = 0.5;
    problem.dt = 0.01;
    // A corner of the box on the floor and at a wall, another corner on the floor, and one near that.
    for (const auto& [x, normal] :
         {std::pair(0.0, Eigen::Vector3d::UnitZ()), std::pair(0.0, Eigen::Vector3d::UnitX()),
          std::pair(0.2, Eigen::Vector3d::UnitZ()), std::pair(0.195, Eigen::Vector3d::UnitZ())}) {
      Contact contact;
      contact.point = {x, 0.1, 0.0};
      contact.normal = normal;
      contacts.push_back(contact);
    }
  }
  static MacGrid oneCell() {
    MacGrid g;
    g.lattice = Lattice({1, 1, 1}, {false, false, false});
    g.h = 0.02;
    return g;
  }
  ContactRows rows(const std::vector<Contact>& of) const {
    return buildContactRows(problem, of, std::vector<ContactLaw>(of.size(), {0.5, 0.0}), {}, 0.1);
  }
};

TEST(WarmStart, IsWhatTheContactsDid) {
  Corner corner;
  const ContactRows rows = corner.rows(corner.contacts);
  Eigen::VectorXd r(12);
  r << 1.0, 2.0, 3.0, 4.0, 0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7, 0.8;
  ContactForces forces;
  std::vector<Wrench> wrenches;
  distributeImpulses(corner.problem, rows, corner.contacts, r, forces, wrenches);
  // Impulses over the step: of the floor 1 + 3 + 4, of the wall 2, and friction.
  EXPECT_NEAR(forces.contacts[1].normal, 2.0 * 0.5 / 0.01, 1e-12);
  EXPECT_LT((warmStart(corner.problem, rows, corner.contacts, forces) - r).norm(), 1e-12);
  // The same load acts half as long in half a step.
  corner.problem.dt = 0.005;
  EXPECT_LT((warmStart(corner.problem, rows, corner.contacts, forces) - 0.5 * r).norm(), 1e-12);
}

TEST(WarmStart, NoForceCountsTwice) {
  Corner corner;
  const std::vector<Contact> one = {corner.contacts[2]};
  ContactForces forces;
  std::vector<Wrench> wrenches;
  distributeImpulses(corner.problem, corner.rows(one), one, Eigen::Vector3d(3.0, 0.0, 0.0), forces, wrenches);
  const Eigen::VectorXd r = warmStart(corner.problem, corner.rows(corner.contacts), corner.contacts, forces);
  EXPECT_NEAR(r[2], 3.0, 1e-12);
  EXPECT_NEAR(r.cwiseAbs().sum(), 3.0, 1e-12);
}

}  // namespace
}  // namespace monolith
