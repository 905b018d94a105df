// Trees of bodies: poses and twists that joints leave, and the wrenches of efforts in them.

#include "rigid/articulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/solid_body.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d turned(const Vector3d& at, const Vector3d& by) {
  Eigen::Isometry3d X(Eigen::AngleAxisd(by.norm(), by.normalized()));
  X.translation() = at;
  return X;
}

// A root, a revolute joint at it, a prismatic one further on, another revolute one at the root.
std::vector<RigidBody> tree() {
  std::vector<BodyDescription> bodies = {boxBody("root", {0.1, 0.2, 0.3}, 900.0, {0.3, -0.2, 0.5})};
  bodies[0].X_WB.linear() = turned({0, 0, 0}, {0.3, 0.5, -0.2}).linear();
  JointDescription joint;
  joint.name = "hip";
  joint.axis = Vector3d(1.0, 2.0, -1.0).normalized();
  joint.X_PJ = turned({0.1, 0.05, -0.2}, {0.7, 0.0, 0.4});
  joint.position = 0.4;
  joint.lower = -0.5;
  joint.upper = 0.6;
  BodyDescription link = boxBody("link", {0.1, 0.1, 0.2}, 2000.0, {0, 0, 0});
  link.p_BBcm = {0.02, -0.03, -0.1};
  hangOn(bodies, 0, link, joint);
  joint.type = JointType::kPrismatic;
  joint.name = "slide";
  joint.position = -0.05;
  hangOn(bodies, 1, link, joint);
  joint.type = JointType::kRevolute;
  joint.name = "tail";
  hangOn(bodies, 0, link, joint);
  std::vector<RigidBody> out;
  for (const BodyDescription& body : bodies) out.push_back(makeRigidBody(body, 0.05));
  out[0].twist << 0.3, -0.1, 0.2, 1.0, -2.0, 0.5;
  out[1].joint_velocity = 1.5;
  out[2].joint_velocity = -0.4;
  out[3].joint_velocity = -2.5;
  placeOnJoints(Vector3d::Zero(), out);
  moveWithJoints(out);
  return out;
}

TEST(Articulation, TwistsAreTheRatesOfPoses) {
  const std::vector<RigidBody> now = tree();
  const double dt = 1e-6;
  const auto at = [&](double time) {
    std::vector<RigidBody> moved = now;
    advancePose(moved[0], time);
    for (RigidBody& body : moved) body.joint_position += time * body.joint_velocity;
    placeOnJoints(Vector3d::Zero(), moved);
    return moved;
  };
  const std::vector<RigidBody> before = at(-dt), after = at(dt);
  for (std::size_t b = 0; b < now.size(); ++b) {
    const Vector3d velocity = (after[b].p_WBcm - before[b].p_WBcm) / (2.0 * dt);
    const Eigen::AngleAxisd turn(after[b].q_WB * before[b].q_WB.conjugate());
    EXPECT_LT((velocity - now[b].twist.head<3>()).norm(), 1e-8) << b;
    EXPECT_LT((turn.angle() / (2.0 * dt) * turn.axis() - now[b].twist.tail<3>()).norm(), 1e-8) << b;
  }
}

TEST(Articulation, JointsVelocitiesAreFoundInTheTwists) {
  std::vector<RigidBody> bodies = tree();
  std::vector<Vector6d> twists;
  for (const RigidBody& body : bodies) twists.push_back(body.twist);
  EXPECT_EQ(jointVelocity(bodies, 0, twists), 0.0);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    EXPECT_NEAR(jointVelocity(bodies, b, twists), bodies[b].joint_velocity, 1e-13);
  }
}

TEST(Articulation, AnEffortDoesWorkOnItsJointAloneAndNoneOnTheWhole) {
  const std::vector<RigidBody> bodies = tree();
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    std::vector<Wrench> wrenches(bodies.size());
    addJointEffort(bodies, b, 3.0, wrenches);
    double power = 0.0;
    Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      power += wrenches[i].force.dot(bodies[i].twist.head<3>()) + wrenches[i].torque.dot(bodies[i].twist.tail<3>());
      force += wrenches[i].force;
      torque += wrenches[i].torque + bodies[i].p_WBcm.cross(wrenches[i].force);
    }
    EXPECT_NEAR(power, 3.0 * bodies[b].joint_velocity, 1e-12);
    EXPECT_LT(force.norm(), 1e-14);
    EXPECT_LT(torque.norm(), 1e-13);
  }
}

TEST(Articulation, ImagesStayWhereTheBodiesWere) {
  const Vector3d period(1.0, 0.0, 0.7);
  std::vector<RigidBody> bodies = tree();
  const std::vector<RigidBody> there = bodies;
  bodies[1].p_WBcm += Vector3d(2.0 * period[0], 0.0, -period[2]);
  placeOnJoints(period, bodies);
  EXPECT_LT((bodies[1].p_WBcm - there[1].p_WBcm - Vector3d(2.0, 0.0, -0.7)).norm(), 1e-13);
  EXPECT_LT((bodies[2].p_WBcm - there[2].p_WBcm).norm(), 1e-13) << "its parent's image does not matter";
  moveWithJoints(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) EXPECT_LT((bodies[b].twist - there[b].twist).norm(), 1e-12) << b;
}

TEST(Articulation, EveryEndOfARangeIsAStop) {
  std::vector<RigidBody> bodies = tree();
  bodies[1].joint->upper = std::numeric_limits<double>::infinity();
  bodies[3].joint->prescribed = PrescribedJointMotion();
  const std::vector<JointStop> stops = jointStops(bodies);
  ASSERT_EQ(stops.size(), 3u) << "of the hip the lower one, of the slide both, of what is prescribed none";
  EXPECT_EQ(stops[0].body, 1);
  EXPECT_EQ(stops[0].sign, 1.0);
  EXPECT_NEAR(stops[0].gap, 0.9, 1e-15);
  EXPECT_EQ(stops[2].body, 2);
  EXPECT_EQ(stops[2].sign, -1.0);
  EXPECT_NEAR(stops[2].gap, 0.65, 1e-15);
  EXPECT_EQ(stops[2].radius, 1.0);
}

// Of the energy while one joint moves alone.
TEST(Articulation, InertiaOfAJointIsThatOfAllBeyondIt) {
  std::vector<RigidBody> bodies = tree();
  const std::vector<double> inertias = jointInertias(bodies);
  EXPECT_EQ(inertias[0], 0.0);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    for (RigidBody& body : bodies) {
      body.joint_velocity = 0.0;
      body.twist.setZero();
    }
    bodies[b].joint_velocity = 2.0;
    moveWithJoints(bodies);
    double energy = 0.0;
    for (const RigidBody& body : bodies) energy += kineticEnergy(body);
    EXPECT_NEAR(inertias[b], energy / 2.0, 1e-12 * energy);
  }
}

TEST(Articulation, NothingIsFasterThanItsFastestPoint) {
  std::vector<RigidBody> bodies = tree();
  bodies[0].twist.setZero();
  std::vector<double> speeds;
  for (const RigidBody& body : bodies) speeds.push_back(std::abs(body.joint_velocity));
  moveWithJoints(bodies);
  const std::vector<double> fastest = fastestPoints(bodies, speeds);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    EXPECT_LE(bodies[b].twist.head<3>().norm(), fastest[b]);
    EXPECT_LE(fastest[b], 5.0 * bodies[b].fastestPoint(bodies[b].twist));
  }
}

TEST(Articulation, NeighboursNeverTouch) {
  std::vector<RigidBody> bodies = tree();
  const std::vector<int> roots = rootsOf(bodies);
  EXPECT_EQ(roots, (std::vector<int>{0, 0, 0, 0}));
  for (const bool self : {false, true}) {
    for (RigidBody& body : bodies) body.self_collision = self;
    EXPECT_FALSE(mayTouch(bodies, roots, 0, 1));
    EXPECT_FALSE(mayTouch(bodies, roots, 2, 1));
    EXPECT_EQ(mayTouch(bodies, roots, 0, 2), self);
    EXPECT_EQ(mayTouch(bodies, roots, 3, 1), self);
  }
  bodies.push_back(RigidBody());
  EXPECT_TRUE(mayTouch(bodies, rootsOf(bodies), 1, 4));
}

}  // namespace
}  // namespace monolith
