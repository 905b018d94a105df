// Bodies on joints: where they are at the start, how fast, and hung on each other by a program.

#include "scene/joint_placement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/joint_motion.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Isometry3d pose(const Vector3d& position, double angle, const Vector3d& axis) {
  return Eigen::Translation3d(position) * AngleAxisd(angle, axis.normalized());
}

// A turning and a sliding joint at odd frames, one on the other, on a body that turns and moves.
std::vector<BodyDescription> chain(const JointType first, const JointType second) {
  std::vector<BodyDescription> bodies{sphereBody("root", 0.1, 500.0, Vector3d(0.3, -0.2, 0.7))};
  bodies[0].X_WB = pose(Vector3d(0.3, -0.2, 0.7), 0.8, Vector3d(1, 2, -1));
  bodies[0].velocity = Vector3d(0.5, -0.4, 0.3);
  bodies[0].angular_velocity = Vector3d(1.5, 0.7, -0.9);
  JointDescription joint;
  joint.name = "first";
  joint.type = first;
  joint.axis = Vector3d(1, -2, 2) / 3.0;
  joint.X_PJ = pose(Vector3d(0.2, 0.1, -0.4), 1.1, Vector3d(0, 1, 3));
  joint.position = 0.6;
  joint.velocity = -1.3;
  hangOn(bodies, 0, sphereBody("upper", 0.1, 500.0, Vector3d::Zero()), joint);
  joint.name = "second";
  joint.type = second;
  joint.axis = Vector3d(2, 1, 2) / 3.0;
  joint.X_PJ = pose(Vector3d(-0.1, 0.3, 0.2), -0.7, Vector3d(2, 0, 1));
  joint.position = -0.35;
  joint.velocity = 0.9;
  hangOn(bodies, 1, sphereBody("lower", 0.1, 500.0, Vector3d::Zero()), joint);
  return bodies;
}

// What it is a time later with all velocities of root and joints kept.
std::vector<BodyDescription> after(std::vector<BodyDescription> bodies, double time) {
  const Vector3d turn = time * bodies[0].angular_velocity;
  bodies[0].X_WB.linear() = AngleAxisd(turn.norm(), turn.normalized()) * bodies[0].X_WB.linear();
  bodies[0].X_WB.translation() += time * bodies[0].velocity;
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    bodies[i].joint->position += time * bodies[i].joint->velocity;
    placeOnParent(bodies[bodies[i].joint->parent], bodies[i]);
  }
  return bodies;
}

TEST(JointPlacement, PoseIsTheParentsThenTheJointsFrameThenItsMotion) {
  const std::vector<BodyDescription> turning = chain(JointType::kRevolute, JointType::kPrismatic);
  // Rodrigues: R = cos 1 + sin [a] + (1 - cos) a a^T.
  const Vector3d a = turning[1].joint->axis;
  Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  const Matrix3d R =
      std::cos(0.6) * Matrix3d::Identity() + std::sin(0.6) * cross + (1.0 - std::cos(0.6)) * a * a.transpose();
  const Isometry3d X_WJ = turning[0].X_WB * turning[1].joint->X_PJ;
  EXPECT_LT((turning[1].X_WB.translation() - X_WJ.translation()).norm(), 1e-15);
  EXPECT_LT((turning[1].X_WB.linear() - X_WJ.linear() * R).norm(), 1e-14);
  const Isometry3d X_WK = turning[1].X_WB * turning[2].joint->X_PJ;
  EXPECT_LT((turning[2].X_WB.linear() - X_WK.linear()).norm(), 1e-14);
  const Vector3d slid = X_WK.translation() - 0.35 * (X_WK.linear() * turning[2].joint->axis);
  EXPECT_LT((turning[2].X_WB.translation() - slid).norm(), 1e-14);
}

TEST(JointPlacement, VelocitiesAreRatesOfThePoses) {
  for (const JointType first : {JointType::kRevolute, JointType::kPrismatic}) {
    for (const JointType second : {JointType::kRevolute, JointType::kPrismatic}) {
      const std::vector<BodyDescription> now = chain(first, second);
      const double h = 1e-5;
      const std::vector<BodyDescription> later = after(now, h), before = after(now, -h);
      for (std::size_t i = 0; i < now.size(); ++i) {
        const Vector3d velocity = (later[i].X_WB.translation() - before[i].X_WB.translation()) / (2.0 * h);
        EXPECT_LT((now[i].velocity - velocity).norm(), 1e-8) << i;
        const AngleAxisd turn(Matrix3d(later[i].X_WB.linear() * before[i].X_WB.linear().transpose()));
        EXPECT_LT((now[i].angular_velocity - turn.angle() / (2.0 * h) * turn.axis()).norm(), 1e-8) << i;
      }
    }
  }
}

TEST(JointPlacement, APrescribedJointHasItsRateAtTheStart) {
  std::vector<BodyDescription> bodies{boxBody("root", Vector3d::Ones(), 500.0, Vector3d::Zero())};
  JointDescription joint;
  joint.axis = Vector3d::UnitY();
  joint.prescribed = PrescribedJointMotion{0.25, 0.1, 2.0, 0.5};
  const BodyDescription& body = hangOn(bodies, 0, sphereBody("ball", 0.1, 500.0, Vector3d::Zero()), joint);
  // Derivative of rate t + amplitude sin(2 pi frequency t + phase) at 0.
  const auto position = [](double t) { return 0.25 * t + 0.1 * std::sin(4.0 * M_PI * t + 0.5); };
  const double rate = (position(1e-5) - position(-1e-5)) / 2e-5;
  EXPECT_NEAR(body.angular_velocity.y(), rate, 1e-7);
  EXPECT_NEAR(body.joint->velocity, rate, 1e-7);
  EXPECT_TRUE(body.velocity.isZero(0.0));
}

TEST(JointPlacement, AProgramsBodiesAreNamedAfterTheRoot) {
  std::vector<BodyDescription> bodies{sphereBody("other", 0.1, 500.0, Vector3d::Zero())};
  bodies.push_back(sphereBody("arm", 0.1, 500.0, Vector3d(1, 2, 3)));
  JointDescription joint;
  joint.name = "shoulder";
  joint.X_PJ.translation() = Vector3d(0, 0, -1);
  BodyDescription upper = sphereBody("upper", 0.1, 500.0, Vector3d(9, 9, 9));
  upper.motion = BodyMotion::kFixed;
  hangOn(bodies, 1, upper, joint);
  BodyDescription& lower = hangOn(bodies, 2, sphereBody("lower", 0.1, 500.0, Vector3d::Zero()), joint);
  ASSERT_EQ(bodies.size(), 4u);
  EXPECT_EQ(&lower, &bodies[3]);
  EXPECT_EQ(bodies[2].name, "arm/upper");
  EXPECT_EQ(bodies[3].name, "arm/lower");
  EXPECT_EQ(bodies[2].motion, BodyMotion::kFree);
  EXPECT_EQ(bodies[2].joint->parent, 1);
  EXPECT_EQ(bodies[3].joint->parent, 2);
  EXPECT_EQ(bodies[3].joint->name, "shoulder");
  EXPECT_EQ(bodies[3].X_WB.translation(), Vector3d(1, 2, 1));
}

}  // namespace
}  // namespace monolith
