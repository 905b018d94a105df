#include "rigid/integration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigid/rotation.h"
#include "rigid_bodies.h"

namespace monolith {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

RigidBody asymmetricBody() {
  RigidBody body;
  body.mass = 2.0;
  // Principal axes turned against the body frame, so that no product of inertia is zero.
  const Matrix3d R = test::turn(37.0, Vector3d(1, 2, 3)).toRotationMatrix();
  body.inertia_Bcm = R * Vector3d(1.0, 2.0, 2.6).asDiagonal() * R.transpose();
  body.q_WB = test::turn(20.0, Vector3d(3, -1, 1));
  return body;
}

double spinEnergy(const RigidBody& body) {
  return 0.5 * body.twist.tail<3>().dot(body.worldInertia() * body.twist.tail<3>());
}

Vector3d spinMomentum(const RigidBody& body) { return body.worldInertia() * body.twist.tail<3>(); }

TEST(FreeTwist, KeepsEnergyAndSizeOfMomentumAtAnySpin) {
  for (const double spin : {1e-3, 1.0, 30.0, 1e3, 1e5}) {
    RigidBody body = asymmetricBody();
    body.twist.tail<3>() = spin * Vector3d(0.3, -1.0, 0.5);
    const double energy = spinEnergy(body), momentum = spinMomentum(body).norm();
    for (int step = 0; step < 2000; ++step) {
      body.twist = freeTwist(body, Vector3d::Zero(), Wrench(), 0.01);
      advancePose(body, 0.01);
    }
    EXPECT_NEAR(spinEnergy(body) / energy, 1.0, 1e-11) << "spin " << spin;
    if (spin <= 30.0) {
      EXPECT_NEAR(spinMomentum(body).norm() / momentum, 1.0, 1e-11) << "spin " << spin;
    }
  }
}

TEST(FreeTwist, TurnsOverAboutTheMiddleAxis) {
  RigidBody body;
  body.inertia_Bcm = Vector3d(1.0, 2.0, 3.0).asDiagonal();
  body.twist.tail<3>() = Vector3d(1e-3, 10.0, 1e-3);
  double least = 1.0, most = -1.0;
  for (int step = 0; step < 20000; ++step) {
    body.twist = freeTwist(body, Vector3d::Zero(), Wrench(), 5e-4);
    advancePose(body, 5e-4);
    const double middle = (body.q_WB.conjugate() * body.twist.tail<3>()).y() / 10.0;
    least = std::min(least, middle);
    most = std::max(most, middle);
  }
  EXPECT_LT(least, -0.999);
  EXPECT_GT(most, 0.999);
}

// Half a step of lag between twist and pose; the momentum's direction must not drift beyond it.
TEST(FreeTwist, MomentumDirectionErrorIsFirstOrderAndDoesNotGrow) {
  double worst[2][2];
  for (int halving = 0; halving < 2; ++halving) {
    const double dt = 0.004 / (1 << halving);
    RigidBody body = asymmetricBody();
    body.twist.tail<3>() = Vector3d(0.3, -3.0, 0.5);
    const Vector3d start = spinMomentum(body);
    worst[halving][0] = worst[halving][1] = 0.0;
    const int steps = 40 / dt;
    for (int step = 0; step < steps; ++step) {
      body.twist = freeTwist(body, Vector3d::Zero(), Wrench(), dt);
      advancePose(body, dt);
      double& error = worst[halving][2 * step / steps];
      error = std::max(error, (spinMomentum(body) - start).norm() / start.norm());
    }
    EXPECT_LT(worst[halving][1], 1.5 * worst[halving][0]);
  }
  EXPECT_LT(worst[0][1], 0.02);
  EXPECT_NEAR(worst[0][1] / worst[1][1], 2.0, 0.3);
}

TEST(FreeTwist, ForceTorqueAndGravity) {
  RigidBody body;
  body.mass = 2.0;
  body.inertia_Bcm = 0.5 * Matrix3d::Identity();
  body.q_WB = test::turn(70.0, Vector3d(1, 1, 0));
  body.twist << 1, 0, 0, 0, 0, 1;
  Wrench wrench;
  wrench.force = Vector3d(4, 0, 2);
  wrench.torque = Vector3d(0, 1, 0);
  const Vector6d twist = freeTwist(body, Vector3d(0, 0, -10), wrench, 0.1);
  Vector6d expected;
  expected << 1.2, 0, -0.9, 0, 0.2, 1;
  EXPECT_LT((twist - expected).norm(), 1e-13);
  for (const BodyMotion motion : {BodyMotion::kFixed, BodyMotion::kPrescribed}) {
    body.motion = motion;
    EXPECT_EQ(freeTwist(body, Vector3d(0, 0, -10), wrench, 0.1), body.twist);
  }
}

TEST(AdvancePose, IsTheExactRotationAboutTheCentreOfMass) {
  RigidBody body;
  body.p_BBcm = Vector3d(0.1, 0.2, -0.3);
  body.p_WBcm = Vector3d(1, 2, 3);
  body.q_WB = test::turn(50.0, Vector3d(1, 0, 2));
  body.twist << 0.5, -1.0, 2.0, 0.7, -2.0, 1.1;
  const RigidBody start = body;
  advancePose(body, 0.8);
  const Vector3d omega = start.twist.tail<3>();
  const Matrix3d turned = Eigen::AngleAxisd(0.8 * omega.norm(), omega.normalized()) * start.q_WB.toRotationMatrix();
  EXPECT_LT((body.q_WB.toRotationMatrix() - turned).norm(), 1e-14);
  EXPECT_LT((body.pose() * body.p_BBcm - (start.p_WBcm + 0.8 * start.twist.head<3>())).norm(), 1e-14);
  for (int i = 0; i < 100000; ++i) advancePose(body, 0.01);
  EXPECT_NEAR(body.q_WB.norm(), 1.0, 1e-15);
}

TEST(Exponential, IsSmoothThroughZero) {
  EXPECT_EQ(exponential(Vector3d::Zero()).w(), 1.0);
  for (const double angle : {1e-12, 1.9e-4, 2.1e-4, 1.0, 3.1, 6.0}) {
    const Quaterniond q = exponential(angle * Vector3d::UnitY());
    EXPECT_NEAR(q.y(), std::sin(0.5 * angle), 1e-15 * (1.0 + angle));
    EXPECT_NEAR(q.w(), std::cos(0.5 * angle), 1e-15 * (1.0 + angle));
  }
}

BodyDescription shaker() {
  BodyDescription description;
  description.name = "shaker";
  description.shapes = {test::boxShape(Vector3d(1, 1, 1))};
  description.motion = BodyMotion::kPrescribed;
  description.p_BBcm = Vector3d(0.3, 0.0, 0.1);
  description.prescribed.frequency = 2.0;
  return description;
}

TEST(PrescribedTwist, IntegratesToTheAmplitude) {
  BodyDescription description = shaker();
  description.prescribed.amplitude << 0.05, 0, -0.02, 0, 0, 0.4;
  RigidBody body = makeRigidBody(description, 0.1);
  const double dt = 0.125 / 2000;  // a quarter of a period
  for (int step = 0; step < 2000; ++step) {
    body.twist = prescribedTwist(body, (step + 0.5) * dt);
    advancePose(body, dt);
  }
  const Eigen::Isometry3d X = body.pose();
  EXPECT_LT((X.translation() - Vector3d(0.05, 0, -0.02)).norm(), 1e-7);
  EXPECT_NEAR(std::atan2(X.linear()(1, 0), X.linear()(0, 0)), 0.4, 1e-6);
}

TEST(PrescribedTwist, ItsMeanEndsWhereTheMotionDoesAtAnyStep) {
  BodyDescription description = shaker();
  description.prescribed.twist << 0.1, 0, 0, 0, 0, 1.0;
  description.prescribed.amplitude << 0.05, 0, -0.02, 0, 0, 0.4;
  description.prescribed.phase = 0.7;
  for (const double dt : {1e-6, 0.1, 0.3, 0.5, 5.3}) {  // the period is 0.5
    RigidBody body = makeRigidBody(description, 0.1);
    for (int step = 0; step < 3; ++step) {
      body.twist = meanPrescribedTwist(body, step * dt, dt);
      advancePose(body, dt);
    }
    const double t = 3.0 * dt, swing = std::sin(4.0 * M_PI * t + 0.7) - std::sin(0.7);
    const Eigen::Isometry3d X = body.pose();
    EXPECT_LT((X.translation() - Vector3d(0.1 * t + 0.05 * swing, 0, -0.02 * swing)).norm(), 1e-13) << dt;
    EXPECT_LT((X.linear() - test::turn((t + 0.4 * swing) * 180.0 / M_PI, Vector3d::UnitZ()).toRotationMatrix()).norm(),
              1e-12)
        << dt;
  }
}

TEST(PrescribedTwist, LeavesAPivotWhereItIsAtAnyStep) {
  BodyDescription description = shaker();
  description.prescribed.twist << 0, 0, 0, 0, 0, 2.0 * M_PI;
  description.X_WB = test::pose(Vector3d(5, 1, 2), test::turn(30.0, Vector3d::UnitX()));
  RigidBody body = makeRigidBody(description, 0.1);
  for (int step = 0; step < 7; ++step) {
    body.twist = prescribedTwist(body, 0.0);
    advancePose(body, 0.1);
    EXPECT_LT((body.pose().translation() - Vector3d(5, 1, 2)).norm(), 1e-14) << step;
  }
}

TEST(PrescribedTwist, IsThatOfTheFrameOrigin) {
  BodyDescription description = shaker();
  description.prescribed.twist << 1, 0, 0, 0, 3, 0;
  description.prescribed.amplitude << 0, 0.1, 0, 0.2, 0, 0;
  description.prescribed.phase = 0.4;
  description.X_WB = test::pose(Vector3d(5, 1, 2), test::turn(90.0, Vector3d::UnitZ()));
  const RigidBody body = makeRigidBody(description, 0.1);
  const double rate = 4.0 * M_PI * std::cos(0.4);
  EXPECT_LT((body.velocityAt(Vector3d(5, 1, 2)) - Vector3d(1, 0.1 * rate, 0)).norm(), 1e-12);
  EXPECT_LT((body.twist.tail<3>() - Vector3d(0.2 * rate, 3, 0)).norm(), 1e-12);
}

TEST(MakeRigidBody, TakesTheDescription) {
  BodyDescription description = shaker();
  description.motion = BodyMotion::kFree;
  description.mass = 7.0;
  description.inertia_Bcm = Vector3d(1, 2, 2.5).asDiagonal();
  description.X_WB = test::pose(Vector3d(5, 1, 2), test::turn(90.0, Vector3d::UnitZ()));
  description.velocity = Vector3d(1, 2, 3);
  description.angular_velocity = Vector3d(0, 0, 2);
  const RigidBody body = makeRigidBody(description, 0.1);
  EXPECT_LT((body.p_WBcm - Vector3d(5, 1.3, 2.1)).norm(), 1e-14);
  EXPECT_LT((body.pose().matrix() - description.X_WB.matrix()).norm(), 1e-14);
  EXPECT_LT((body.velocityAt(Vector3d(5, 1, 2)) - description.velocity).norm(), 1e-14);
  EXPECT_LT((body.worldInertia().diagonal() - Vector3d(2, 1, 2.5)).norm(), 1e-14);
  EXPECT_NEAR(body.distance->distance(Vector3d(0, 0, 0.7)), 0.2, 1e-12);

  description.motion = BodyMotion::kFixed;
  EXPECT_EQ(makeRigidBody(description, 0.1).twist, Vector6d(Vector6d::Zero()));
}

}  // namespace
}  // namespace monolith
