// Bodies that joints connect, in liquid.

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "simulation/jointed_bodies.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kCell = 0.02;

Scene filledTank(const Vector3d& cells, double viscosity, double dt) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = kCell * cells;
  scene.tank.cell_width = kCell;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = scene.tank.size.z();
  scene.time_step = dt;
  scene.solver.tolerance = 1e-7;
  return scene;
}

// Two blocks end to end, the second a joint's or of the same body.
Scene twoBlocks(bool joined, double viscosity) {
  Scene scene = filledTank({24, 20, 24}, viscosity, 0.02);
  const Vector3d size(0.12, 0.08, 0.08), at(0.2, 0.2, 0.3);
  BodyDescription first = boxBody("block", size, 1500.0, at);
  first.angular_velocity = {0.0, 1.5, 0.5};
  BodyDescription second = boxBody("end", size, 3000.0, Vector3d::Zero());
  if (joined) {
    JointDescription locked = hinge(Vector3d::UnitY(), {size.x(), 0.0, 0.0}, 0.0);
    locked.lower = locked.upper = 0.0;
    scene.bodies.push_back(first);
    hangOn(scene.bodies, 0, second, locked);
    return scene;
  }
  second.shapes[0].X_BG.translation().x() = size.x();
  first.shapes.push_back(second.shapes[0]);
  const double mass = first.mass + second.mass, centre = second.mass / mass * size.x();
  Eigen::Matrix3d inertia = first.inertia_Bcm + second.inertia_Bcm;
  for (int a : {1, 2}) {
    inertia(a, a) += first.mass * centre * centre + second.mass * std::pow(size.x() - centre, 2);
  }
  first.inertia_Bcm = inertia;
  first.mass = mass;
  first.p_BBcm.x() = centre;
  scene.bodies.push_back(first);
  return scene;
}

TEST(JointInLiquid, ThatIsLockedMakesOneBody) {
  for (const double viscosity : {0.0, 5.0}) {
    Simulation two(twoBlocks(true, viscosity)), one(twoBlocks(false, viscosity));
    for (int step = 0; step < 14; ++step) {  // it does not come to the floor
      stepOn(two);
      stepOn(one);
      EXPECT_NEAR(two.jointStates()[0].position, 0.0, 1e-5);
    }
    const RigidBody &a = two.bodies()[0], &b = one.bodies()[0];
    const double fallen = 0.3 - b.pose().translation().z();
    EXPECT_GT(fallen, 0.02);
    EXPECT_LT((a.pose().translation() - b.pose().translation()).norm(), 0.01 * fallen) << viscosity;
    const double turned = b.q_WB.angularDistance(Eigen::Quaterniond::Identity());
    EXPECT_GT(turned, 0.05);
    EXPECT_LT(a.q_WB.angularDistance(b.q_WB), 0.02 * turned) << viscosity;
  }
}

// E. M. Purcell, 'Life at low Reynolds number', American Journal of Physics 45, 1977: without inertia a swimmer with
// one hinge goes nowhere, whatever its strokes; one with two does, if they do not move at once, and there and back if
// the strokes run backwards.
double swims(int hinges, bool backwards, double phase) {
  Scene scene = filledTank({26, 18, 12}, 500.0, 0.05);
  scene.gravity.setZero();
  const Vector3d size(0.08, 0.04, 0.06);
  JointDescription joint = hinge(Vector3d::UnitZ(), {size.x(), 0.0, 0.0}, 0.0);
  PrescribedJointMotion stroke{0.0, 0.6, 0.5, 0.0};
  scene.bodies.push_back(boxBody("head", size, 1000.0, {0.18, 0.18, 0.12}));
  for (int i = 0; i < hinges; ++i) {
    stroke.phase = i == 0 ? 0.0 : backwards ? -phase : phase;
    joint.prescribed = stroke;
    joint.position = joint.prescribed->amplitude * std::sin(stroke.phase);
    hangOn(scene.bodies, i, boxBody("link" + std::to_string(i), size, 1000.0, Vector3d::Zero()), joint);
  }
  Simulation simulation(scene);
  const auto middle = [&] {
    Vector3d sum = Vector3d::Zero();
    for (const RigidBody& body : simulation.bodies()) sum += body.p_WBcm;
    return Vector3d(sum / static_cast<double>(simulation.bodies().size()));
  };
  // One period, from where it has been once.
  for (int step = 0; step < 40; ++step) stepOn(simulation);
  const Vector3d before = middle();
  for (int step = 0; step < 40; ++step) stepOn(simulation);
  return (middle() - before).x() / size.x();
}

TEST(JointInLiquid, WithoutInertiaOneHingeDoesNotSwimAndTwoDo) {
  const double scallop = swims(1, false, 0.0), there = swims(2, false, 0.5 * M_PI), back = swims(2, true, 0.5 * M_PI);
  EXPECT_GT(std::abs(there), 0.015);
  EXPECT_LT(std::abs(scallop), 0.05 * std::abs(there));
  EXPECT_LT(std::abs(there + back), 0.25 * std::abs(there));
}

// Links much lighter than the liquid, which is thick, a servo that is stiff, steps that are long: nothing of it is
// dangerous.
TEST(JointInLiquid, LightLinksInThickLiquidAreStable) {
  for (const double density : {1.0, 100.0}) {
    Scene scene = filledTank({16, 16, 16}, 100.0, 0.1);
    scene.solver.tolerance = 1e-5;
    scene.bodies.push_back(boxBody("base", {0.1, 0.1, 0.06}, 1000.0, {0.16, 0.16, 0.27}));
    scene.bodies[0].motion = BodyMotion::kFixed;
    JointDescription joint = hinge(Vector3d::UnitY(), {0.0, 0.0, -0.04}, 0.3);
    joint.servo = {1e4, 10.0};
    hangOn(scene.bodies, 0, hangingBar("bar", 0.14, 0.06, density), joint);
    Simulation simulation(scene);
    simulation.setJointCommand(1, {0.0, -0.3, 0.0});
    for (int step = 0; step < 30; ++step) stepOn(simulation);
    EXPECT_NEAR(simulation.jointStates()[0].position, -0.3, 1e-3) << density;
    EXPECT_NEAR(simulation.jointStates()[0].velocity, 0.0, 1e-3) << density;
  }
}

TEST(JointInLiquid, IsTheSameAtAnyNumberOfThreads) {
  std::vector<std::vector<RigidBody>> after;
  for (const int threads : {1, 2}) {
    Scene scene = filledTank({16, 16, 20}, 0.5, 0.02);
    scene.liquid.fill_level = 0.25;
    scene.solver.threads = threads;
    scene.bodies.push_back(boxBody("base", {0.09, 0.1, 0.06}, 500.0, {0.16, 0.16, 0.25}));
    JointDescription joint = hinge(Vector3d::UnitY(), {0.0, 0.0, -0.04}, 0.3);
    joint.friction = 0.01;
    joint.lower = 0.1;
    hangOn(scene.bodies, 0, hangingBar("bar", 0.14, 0.06, 1500.0), joint);
    Simulation simulation(scene);
    for (int step = 0; step < 15; ++step) stepOn(simulation);
    after.push_back(simulation.bodies());
  }
  for (std::size_t b = 0; b < 2; ++b) {
    for (const auto& other : after) {
      EXPECT_EQ(other[b].p_WBcm, after[0][b].p_WBcm);
      EXPECT_EQ(other[b].q_WB.coeffs(), after[0][b].q_WB.coeffs());
      EXPECT_EQ(other[b].joint_velocity, after[0][b].joint_velocity);
    }
  }
}

// A swimmer that crosses a periodic boundary does not notice it.
TEST(JointInLiquid, CrossesAPeriodicBoundary) {
  std::vector<double> speeds[2];
  for (const int crosses : {0, 1}) {
    Scene scene = filledTank({20, 14, 14}, 1.0, 0.02);
    scene.gravity.setZero();
    scene.tank.periodic[0] = true;
    const double start = crosses == 1 ? 0.3 : 0.1;
    scene.bodies.push_back(boxBody("head", {0.08, 0.08, 0.08}, 1000.0, {start, 0.14, 0.14}));
    scene.bodies[0].velocity = {0.3, 0.0, 0.0};
    JointDescription joint = hinge(Vector3d::UnitZ(), {-0.06, 0.0, 0.0}, 0.2);
    BodyDescription tail = boxBody("tail", {0.1, 0.06, 0.06}, 1500.0, Vector3d::Zero());
    tail.shapes[0].X_BG.translation().x() = tail.p_BBcm.x() = -0.06;
    hangOn(scene.bodies, 0, tail, joint);
    Simulation simulation(scene);
    for (int step = 0; step < 25; ++step) {
      stepOn(simulation);
      speeds[crosses].push_back(simulation.jointStates()[0].position);
      for (const RigidBody& body : simulation.bodies()) {
        EXPECT_GE(body.p_WBcm.x(), 0.0);
        EXPECT_LE(body.p_WBcm.x(), 0.4);
      }
    }
  }
  EXPECT_GT(std::abs(speeds[0].back() - 0.2), 1e-3);
  for (std::size_t i = 0; i < speeds[0].size(); ++i) EXPECT_NEAR(speeds[0][i], speeds[1][i], 1e-5);
}

}  // namespace
}  // namespace monolith
