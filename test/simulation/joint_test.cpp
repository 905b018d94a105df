// Bodies that joints connect, without liquid: what mechanics knows of them.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "simulation/jointed_bodies.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kLength = 0.3;

// One bar on a fixed block, its hinge horizontal.
Scene pendulum(double dt, double position, const JointDescription& of = {}) {
  Scene scene = emptyRoom(dt);
  scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {1.0, 1.0, 1.0}));
  scene.bodies[0].motion = BodyMotion::kFixed;
  JointDescription joint = of;
  joint.name = "hinge";
  joint.axis = Vector3d::UnitY();
  joint.position = position;
  hangOn(scene.bodies, 0, hangingBar("bar", kLength, 0.04, 1000.0), joint);
  return scene;
}

JointState joint(const Simulation& simulation) { return simulation.jointStates().at(0); }

// N m, by which gravity turns the bar back at an angle.
double weightTorque(const Scene& scene, double angle) {
  return scene.bodies[1].mass * -scene.gravity.z() * 0.5 * kLength * std::sin(angle);
}

// Mean of some periods after the first, in which there is a step of first order.
double period(double dt) {
  Simulation simulation(pendulum(dt, 0.3));
  std::vector<double> crossings;
  double before = 0.3;
  while (crossings.size() < 5) {
    stepOn(simulation);
    const double now = joint(simulation).position;
    if (before > 0.0 && now <= 0.0) crossings.push_back(simulation.time() - dt * now / (now - before));
    before = now;
  }
  return (crossings.back() - crossings[1]) / 3.0;
}

TEST(Joint, APendulumSwingsInItsTime) {
  const Scene scene = pendulum(0.01, 0.3);
  const double g = -scene.gravity.z();
  // T = 4 sqrt(I/(m g r)) K(sin(q/2))
  const double expected = 4.0 * std::sqrt(barInertia(scene.bodies[1]) / (scene.bodies[1].mass * g * 0.5 * kLength)) *
                          std::comp_ellint_1(std::sin(0.15));
  const double coarse = std::abs(period(0.02) / expected - 1.0), fine = std::abs(period(0.01) / expected - 1.0);
  EXPECT_LT(coarse, 2.5e-3);
  EXPECT_LT(fine, 0.4 * coarse);
}

TEST(Joint, AFloatingChainKeepsItsMomentum) {
  Scene scene = emptyRoom(0.005);
  scene.gravity.setZero();
  scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {1.0, 1.0, 1.0}));
  scene.bodies[0].angular_velocity = {0.3, 0.2, 0.1};
  const Vector3d axes[] = {Vector3d::UnitY(), Vector3d::UnitX(), Vector3d(1.0, 1.0, 0.5).normalized()};
  for (int i = 0; i < 3; ++i) {
    JointDescription joint = hinge(axes[i], {0.0, 0.0, i == 0 ? 0.0 : -0.2}, 0.5);
    if (i == 1) joint.type = JointType::kPrismatic;
    joint.velocity = i == 1 ? 0.1 : 2.0;
    // Inside, between them, nothing is lost or won.
    joint.damping = 0.02;
    joint.friction = 0.01;
    joint.servo.stiffness = 1.0;
    hangOn(scene.bodies, i, hangingBar("bar" + std::to_string(i), 0.2, 0.04, 500.0 * (i + 1)), joint);
  }
  Simulation simulation(scene);
  simulation.setJointCommand(1, {0.02, 0.3, 0.0});
  const auto momentum = [&] {
    Vector6d sum = Vector6d::Zero();
    for (const RigidBody& body : simulation.bodies()) {
      const Vector3d p = body.mass * body.twist.head<3>();
      sum.head<3>() += p;
      sum.tail<3>() += body.p_WBcm.cross(p) + body.worldInertia() * body.twist.tail<3>();
    }
    return sum;
  };
  const Vector6d before = momentum();
  const double moved = simulation.jointStates()[0].position;
  for (int step = 0; step < 60; ++step) stepOn(simulation);
  EXPECT_LT((momentum() - before).head<3>().norm(), 1e-8 * before.head<3>().norm());
  EXPECT_LT((momentum() - before).tail<3>().norm(), 1e-3 * before.tail<3>().norm());
  EXPECT_GT(std::abs(simulation.jointStates()[0].position - moved), 0.1);
}

TEST(Joint, StaysTogether) {
  Scene scene = emptyRoom(0.02);
  scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {1.0, 1.0, 1.6}));
  hangOn(scene.bodies, 0, hangingBar("upper", 0.3, 0.04, 1000.0), hinge(Vector3d::UnitY(), {0.0, 0.0, -0.05}, 1.2));
  hangOn(scene.bodies, 1, hangingBar("lower", 0.3, 0.04, 3000.0), hinge(Vector3d::UnitX(), {0.0, 0.0, -0.3}, -0.8));
  Simulation simulation(scene);
  for (int step = 0; step < 100; ++step) {
    stepOn(simulation);
    for (int b : {1, 2}) {
      const RigidBody &body = simulation.bodies()[b], &parent = simulation.bodies()[b - 1];
      EXPECT_LT((body.pose().translation() - parent.pose() * body.joint->X_PJ.translation()).norm(), 1e-12);
      EXPECT_LT((body.q_WB * body.joint->axis - parent.q_WB * body.joint->axis).norm(), 1e-12);
    }
  }
  EXPECT_LT(simulation.bodies()[0].p_WBcm.z(), 1.2) << "it has fallen";
}

TEST(Joint, ComesToRestOnAStop) {
  JointDescription limited;
  limited.lower = 0.3;
  limited.upper = 1.5;
  const Scene scene = pendulum(0.01, 1.0, limited);
  Simulation simulation(scene);
  double least = 1.0;
  for (int step = 0; step < 100; ++step) {
    stepOn(simulation);
    least = std::min(least, joint(simulation).position);
  }
  EXPECT_GT(least, 0.3 - 1e-6);
  EXPECT_NEAR(joint(simulation).position, 0.3, 1e-6);
  EXPECT_NEAR(joint(simulation).velocity, 0.0, 1e-6);
  // And leaves it freely.
  simulation.setJointCommand(1, {2.0 * weightTorque(scene, 0.3), 0.0, 0.0});
  stepOn(simulation);
  EXPECT_NEAR(joint(simulation).velocity, 0.01 * weightTorque(scene, 0.3) / barInertia(scene.bodies[1]), 1e-4);
}

TEST(Joint, AnEffortTurnsIt) {
  Scene scene = pendulum(0.02, 0.0);
  scene.gravity.setZero();
  Simulation simulation(scene);
  simulation.setJointCommand(1, {0.05, 0.0, 0.0});
  for (int step = 0; step < 10; ++step) stepOn(simulation);
  EXPECT_NEAR(joint(simulation).velocity, 0.2 * 0.05 / barInertia(scene.bodies[1]), 1e-4);
  EXPECT_NEAR(joint(simulation).effort, 0.05, 1e-12);
}

TEST(Joint, EffortsAreLimited) {
  JointDescription weak;
  weak.most_effort = 0.01;
  weak.servo.stiffness = 100.0;
  Scene scene = pendulum(0.02, 0.0, weak);
  scene.gravity.setZero();
  Simulation simulation(scene);
  simulation.setJointCommand(1, {0.05, 2.0, 0.0});
  for (int step = 0; step < 10; ++step) stepOn(simulation);
  EXPECT_NEAR(joint(simulation).velocity, 0.2 * 0.01 / barInertia(scene.bodies[1]), 1e-6);
  EXPECT_NEAR(joint(simulation).effort, 0.01, 1e-12);
}

TEST(Joint, DampingLetsItsSpeedDieAway) {
  JointDescription damped;
  damped.damping = 0.05;
  damped.velocity = 1.0;
  const auto speed = [&](double dt) {
    Scene scene = pendulum(dt, 0.0, damped);
    scene.gravity.setZero();
    Simulation simulation(scene);
    while (simulation.time() < 0.5 - 1e-9) stepOn(simulation);
    return joint(simulation).velocity / std::exp(-0.05 * 0.5 / barInertia(scene.bodies[1]));
  };
  const double coarse = std::abs(speed(0.05) - 1.0), fine = std::abs(speed(0.025) - 1.0);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(fine, 0.35 * coarse);
}

TEST(Joint, FrictionHoldsAndSlows) {
  JointDescription rough;
  rough.friction = 0.2;
  // Gravity pulls by less at 0.05 rad, by more at 1 rad.
  const Scene held = pendulum(0.02, 0.05, rough);
  ASSERT_LT(weightTorque(held, 0.05), 0.2);
  ASSERT_GT(weightTorque(held, 1.0), 0.2);
  Simulation simulation(held);
  for (int step = 0; step < 50; ++step) stepOn(simulation);
  EXPECT_NEAR(joint(simulation).position, 0.05, 1e-5);
  Simulation loose(pendulum(0.02, 1.0, rough));
  stepOn(loose);
  EXPECT_NEAR(joint(loose).velocity, -0.02 * (weightTorque(held, 1.0) - 0.2) / barInertia(held.bodies[1]), 1e-2);
  // Constant, until it stands; and then stands.
  rough.velocity = 3.0;
  Scene sliding = pendulum(0.02, 0.0, rough);
  sliding.gravity.setZero();
  Simulation slower(sliding);
  const double rate = 0.2 / barInertia(sliding.bodies[1]);
  for (double time = 0.02; time < 3.0 / rate; time += 0.02) {
    stepOn(slower);
    EXPECT_NEAR(joint(slower).velocity, 3.0 - rate * time, 1e-2) << time;
  }
  for (int step = 0; step < 10; ++step) stepOn(slower);
  EXPECT_NEAR(joint(slower).velocity, 0.0, 1e-5);
  EXPECT_NEAR(joint(slower).position, 0.5 * 3.0 * 3.0 / rate, 0.02);
}

TEST(Joint, AServoHoldsHoweverStiffItIs) {
  for (const double stiffness : {5.0, 1e3, 1e6}) {
    JointDescription driven;
    driven.servo = {stiffness, 0.3 * std::sqrt(stiffness)};
    const Scene scene = pendulum(0.04, 0.0, driven);
    Simulation simulation(scene);
    simulation.setJointCommand(1, {0.0, 0.8, 0.0});
    for (int step = 0; step < 200; ++step) stepOn(simulation);
    const double angle = joint(simulation).position;
    EXPECT_NEAR(stiffness * (0.8 - angle), weightTorque(scene, angle), 1e-3 * weightTorque(scene, 0.8)) << stiffness;
    EXPECT_NEAR(joint(simulation).effort, weightTorque(scene, angle), 1e-3 * weightTorque(scene, 0.8)) << stiffness;
    EXPECT_NEAR(joint(simulation).velocity, 0.0, 1e-4) << stiffness;
  }
}

TEST(Joint, APrescribedOneMovesAsItIsToldAndTellsWhatThatTakes) {
  JointDescription moved;
  moved.prescribed = PrescribedJointMotion{0.2, 0.5, 0.5, 0.3};
  const Scene scene = pendulum(0.02, 0.1, moved);
  Simulation simulation(scene);
  const double omega = M_PI;
  for (int step = 0; step < 60; ++step) {
    stepOn(simulation);
    const double t = simulation.time(), phase = omega * t + 0.3;
    EXPECT_NEAR(joint(simulation).position, 0.1 + 0.2 * t + 0.5 * (std::sin(phase) - std::sin(0.3)), 1e-12);
    if (step < 5) continue;
    const double between = omega * (t - 0.01) + 0.3,
                 angle = 0.1 + 0.2 * (t - 0.01) + 0.5 * (std::sin(between) - std::sin(0.3));
    const double expected =
        -barInertia(scene.bodies[1]) * 0.5 * omega * omega * std::sin(between) + weightTorque(scene, angle);
    EXPECT_NEAR(joint(simulation).effort, expected, 0.01 * weightTorque(scene, 1.0)) << step;
  }
  EXPECT_THROW(simulation.setJointCommand(1, {1.0, 0.0, 0.0}), std::invalid_argument);
}

TEST(Joint, WhatHangsOnABodyGoesWithIt) {
  Scene scene = emptyRoom(0.02);
  scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {1.0, 1.0, 1.0}));
  JointDescription at = hinge(Vector3d::UnitY(), {0.0, 0.0, -0.05}, 0.4);
  at.lower = -1.0;
  at.upper = 1.0;
  hangOn(scene.bodies, 0, hangingBar("bar", kLength, 0.04, 1000.0), at);
  Simulation simulation(scene);
  const Eigen::Isometry3d between = simulation.bodies()[0].pose().inverse() * simulation.bodies()[1].pose();
  Eigen::Isometry3d to(Eigen::AngleAxisd(0.7, Vector3d::UnitX()));
  to.translation() = Vector3d(0.8, 1.1, 0.9);
  simulation.setBodyState(0, to, {0.1, 0.0, 0.0}, {0.0, 0.0, 1.0});
  EXPECT_TRUE((simulation.bodies()[0].pose().inverse() * simulation.bodies()[1].pose()).isApprox(between, 1e-12));
  EXPECT_LT((simulation.bodies()[1].velocityAt(to.translation()) - Vector3d(0.1, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_THROW(simulation.setBodyState(1, to, Vector3d::Zero(), Vector3d::Zero()), std::invalid_argument);
  simulation.setJointStates({{1, -0.6, 0.5, 0.0}});
  EXPECT_EQ(joint(simulation).position, -0.6);
  EXPECT_EQ(joint(simulation).velocity, 0.5);
  const Eigen::Quaterniond relative = simulation.bodies()[1].q_WB.conjugate() * simulation.bodies()[0].q_WB;
  EXPECT_NEAR(Eigen::AngleAxisd(relative).angle(), 0.6, 1e-12);
  EXPECT_THROW(simulation.setJointStates({{1, 1.2, 0.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(simulation.setJointStates({{0, 0.0, 0.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(simulation.setJointStates({{1, std::nan(""), 0.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(simulation.setJointCommand(1, {std::nan(""), 0.0, 0.0}), std::invalid_argument);
  to.translation().z() = 0.2;  // the bar would be in the floor
  EXPECT_THROW(simulation.setBodyState(0, to, Vector3d::Zero(), Vector3d::Zero()), std::invalid_argument);
  EXPECT_EQ(joint(simulation).position, -0.6);
  simulation.reset();
  EXPECT_EQ(joint(simulation).position, 0.4);
  stepOn(simulation);
  EXPECT_EQ(simulation.report().model.joints, 1);
  simulation.reset();
  EXPECT_LT((simulation.bodies()[0].p_WBcm - Vector3d(1.0, 1.0, 1.0)).norm(), 1e-15);
}

// About axes that turn as well.
TEST(Joint, AFreeAssemblyThatTumblesKeepsEnergyAndAngularMomentum) {
  const auto drift = [](double dt) {
    Scene scene = emptyRoom(dt);
    scene.gravity.setZero();
    scene.bodies.push_back(boxBody("base", {0.1, 0.14, 0.2}, 1000.0, {1.0, 1.0, 1.0}));
    scene.bodies[0].angular_velocity = {6.0, 1.0, 3.0};
    JointDescription joint = hinge(Vector3d(1.0, 2.0, 0.5).normalized(), {0.05, 0.0, -0.1}, 0.4);
    joint.velocity = 1.0;
    hangOn(scene.bodies, 0, hangingBar("bar", 0.3, 0.06, 1000.0), joint);
    Simulation simulation(scene);
    const auto state = [&] {
      double energy = 0.0;
      Vector3d spin = Vector3d::Zero();
      for (const RigidBody& body : simulation.bodies()) {
        energy += kineticEnergy(body);
        spin += body.mass * body.p_WBcm.cross(body.twist.head<3>()) + body.worldInertia() * body.twist.tail<3>();
      }
      return std::pair(energy, spin);
    };
    const auto [energy, spin] = state();
    while (simulation.time() < 2.0 - 1e-9) stepOn(simulation);
    const auto [later, turned] = state();
    return std::pair(std::abs(later / energy - 1.0), (turned - spin).norm() / spin.norm());
  };
  const auto [energy, spin] = drift(0.02);
  const auto [fine_energy, fine_spin] = drift(0.01);
  EXPECT_LT(energy, 0.02);
  EXPECT_LT(spin, 0.02);
  EXPECT_LT(fine_energy, 0.35 * energy);
  EXPECT_LT(fine_spin, 0.35 * spin);
}

TEST(Joint, AServoAtItsLimitFindsItsWay) {
  for (const double stiffness : {1e2, 1e4, 1e5}) {
    JointDescription weak;
    weak.servo.stiffness = stiffness;
    weak.servo.damping = 0.1 * stiffness;
    weak.most_effort = 1.0;
    Scene scene = pendulum(0.02, 0.0, weak);
    scene.gravity.setZero();
    Simulation simulation(scene);
    simulation.setJointCommand(1, {0.0, 0.5, 0.0});
    for (int step = 0; step < 200; ++step) {
      stepOn(simulation);
      EXPECT_EQ(simulation.report().retries, 0) << stiffness;
      EXPECT_LE(std::abs(joint(simulation).effort), 1.0 + 1e-9);
    }
    EXPECT_NEAR(joint(simulation).position, 0.5, 0.05) << stiffness;
  }
}

// However far a servo wants to go within a step.
TEST(Joint, ServosGoThroughNothing) {
  for (const double stiffness : {1e3, 1e5}) {
    JointDescription limited;
    limited.servo.stiffness = stiffness;
    limited.lower = -0.5;
    limited.upper = 0.5;
    Simulation against_end(pendulum(0.02, 0.0, limited));
    against_end.setJointCommand(1, {0.0, 2.0, 0.0});
    for (int step = 0; step < 20; ++step) {
      stepOn(against_end);
      EXPECT_LT(joint(against_end).position, 0.5 + 1e-6) << stiffness;
    }
    EXPECT_NEAR(joint(against_end).position, 0.5, 1e-6) << stiffness;

    Scene scene = emptyRoom(0.02);
    scene.solver.cfl = 0.75;
    scene.bodies = {boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {0.4, 1.0, 1.0}),
                    boxBody("wall", {0.1, 0.4, 0.4}, 1000.0, {0.95, 1.0, 1.0})};
    for (BodyDescription& body : scene.bodies) body.motion = BodyMotion::kFixed;
    JointDescription slide = hinge(Vector3d::UnitX(), {0.2, 0.0, 0.0}, 0.0);
    slide.type = JointType::kPrismatic;
    slide.servo.stiffness = stiffness;
    hangOn(scene.bodies, 0, boxBody("slider", {0.1, 0.1, 0.1}, 1000.0, Vector3d::Zero()), slide);
    Simulation against_body(scene);
    against_body.setJointCommand(2, {0.0, 0.9, 0.0});
    for (int step = 0; step < 20; ++step) stepOn(against_body);
    EXPECT_NEAR(joint(against_body).position, 0.25, 1e-4) << stiffness;
  }
}

TEST(Joint, FrictionHoldsAHeavyLoadBeyondALightLink) {
  for (const double density : {1.0, 1000.0}) {
    Scene scene = emptyRoom(0.02);
    scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.1}, 1000.0, {1.0, 1.0, 1.0}));
    scene.bodies[0].motion = BodyMotion::kFixed;
    JointDescription rough = hinge(Vector3d::UnitY(), {0.0, 0.0, 0.0}, 1.0);
    rough.friction = 50.0;
    hangOn(scene.bodies, 0, hangingBar("link", 0.2, 0.02, density), rough);
    rough.axis = Vector3d::UnitX();
    rough.X_PJ.translation().z() = -0.2;
    hangOn(scene.bodies, 1, hangingBar("load", 0.2, 0.1, 2000.0), rough);
    Simulation simulation(scene);
    for (int step = 0; step < 100; ++step) stepOn(simulation);
    for (const JointState& state : simulation.jointStates()) {
      EXPECT_NEAR(state.position, 1.0, 1e-5) << density;
      EXPECT_LT(std::abs(state.velocity), 1.001e-6) << density;
    }
  }
}

// What is prescribed has its way through the floor, too, and is told of.
TEST(Joint, APrescribedOneOnAFixedBaseStopsForNothing) {
  JointDescription moved;
  moved.prescribed = PrescribedJointMotion{-0.5, 0.0, 0.0, 0.0};
  Scene scene = pendulum(0.02, 1.0, moved);
  scene.bodies[0].X_WB.translation().z() = 0.25;
  // A ball is in its way.
  scene.bodies.push_back(sphereBody("ball", 0.05, 500.0, {0.85, 1.0, 0.05}));
  Simulation simulation(scene);
  std::string warnings;
  for (int step = 0; step < 100; ++step) {
    stepOn(simulation);
    warnings += simulation.report().warning;
  }
  EXPECT_NEAR(joint(simulation).position, 0.0, 1e-9);
  EXPECT_NE(warnings.find("base/bar"), std::string::npos) << warnings;
  EXPECT_GT(simulation.bodies()[2].p_WBcm.x(), 1.0) << "pushed aside";
}

TEST(Joint, WhatIsReportedCanBeSet) {
  JointDescription limited;
  limited.lower = 0.3;
  limited.upper = 1.5;
  Simulation simulation(pendulum(0.02, 1.0, limited));
  for (int step = 0; step < 60; ++step) {
    stepOn(simulation);
    const JointState now = joint(simulation);
    EXPECT_NO_THROW(simulation.setJointStates({now})) << step;
    EXPECT_EQ(joint(simulation).position, now.position);
  }
  const JointState now = joint(simulation);
  EXPECT_THROW(simulation.setJointStates({now, now}), std::invalid_argument) << "which of the two?";
}

}  // namespace
}  // namespace monolith
