// Friction, restitution and the choice of what a step models, through whole simulations.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/solid_body.h"
#include "simulation/contact_laws.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr double kDegree = M_PI / 180.0;

// A box on a floor that is tilted by `angle`, in a full tank or a dry one.
Scene slope(double angle, bool wet) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = {0.6, 0.4, 0.3};
  scene.tank.cell_width = 0.05;
  scene.liquid.dynamic_viscosity = 0.1;
  scene.liquid.fill_level = wet ? 0.3 : 0.0;
  scene.gravity = 9.81 * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  scene.contact.friction = 0.5;
  scene.bodies.push_back(boxBody("box", {0.16, 0.16, 0.1}, 2500.0, {0.2, 0.2, 0.05}));
  return scene;
}

double slide(const Scene& scene, int steps) {
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
  }
  return simulation.bodyStates()[0].X_WB.translation()[0] - 0.2;
}

TEST(Friction, BoxSticksBelowTheFrictionAngleAndSlidesAbove) {
  const double threshold = std::atan(0.5);
  for (const bool wet : {false, true}) {
    EXPECT_LT(std::abs(slide(slope(threshold - 0.1 * kDegree, wet), 100)), 1e-7) << wet;
    EXPECT_GT(slide(slope(threshold + 0.1 * kDegree, wet), 20), 1e-5) << wet;
  }
}

TEST(Friction, DrySlidingIsCoulombs) {
  const double angle = 35.0 * kDegree, dt = 0.02;
  const double a = 9.81 * (std::sin(angle) - 0.5 * std::cos(angle));
  // Exact for a constant acceleration, but for the two short steps of backward Euler at the start.
  const double time = 15 * dt, first = 0.25 * dt;
  EXPECT_NEAR(slide(slope(angle, false), 15), 0.5 * a * time * time + a * first * first, 1e-7);
  Scene euler = slope(angle, false);
  euler.solver.time_stepping = TimeStepping::kBackwardEuler;
  EXPECT_NEAR(slide(euler, 15), 0.5 * a * dt * dt * 15 * 16, 1e-7);
}

TEST(Friction, OfAContactOutOfReachChangesNoBit) {
  Scene scene = slope(0.0, true);
  scene.bodies[0].X_WB.translation()[2] = 0.2;
  Scene smooth = scene;
  smooth.contact.friction = 0.0;
  Simulation a(scene), b(smooth);
  for (int i = 0; i < 2; ++i) {
    const StepReport r = a.step();
    ASSERT_TRUE(r.committed());
    EXPECT_EQ(r.model.contacts, 0);
    EXPECT_FALSE(r.model.friction);
    ASSERT_TRUE(b.step().committed());
  }
  EXPECT_EQ(a.bodies()[0].twist, b.bodies()[0].twist);
  EXPECT_EQ(a.bodies()[0].p_WBcm, b.bodies()[0].p_WBcm);
}

TEST(Restitution, BallReboundsAtItsShareOfTheSpeedAndComesToRest) {
  Scene scene = slope(0.0, false);
  scene.time_step = 0.002;
  scene.contact.restitution = 0.8;
  scene.bodies[0] = sphereBody("ball", 0.05, 1000.0, {0.3, 0.2, 0.15});
  Simulation simulation(scene);
  double down = 0.0, up = 0.0;
  for (int i = 0; i < 120; ++i) {
    ASSERT_TRUE(simulation.step().committed());
    const double v = simulation.bodyStates()[0].velocity[2];
    down = std::min(down, v);
    up = std::max(up, v);
  }
  EXPECT_NEAR(down, -std::sqrt(2.0 * 9.81 * 0.1), 0.03);
  EXPECT_NEAR(up / -down, 0.8, 0.02);
  for (int i = 0; i < 1500; ++i) ASSERT_TRUE(simulation.step().committed());
  EXPECT_LT(std::abs(simulation.bodyStates()[0].velocity[2]), 1e-6);
  EXPECT_NEAR(simulation.bodyStates()[0].X_WB.translation()[2], 0.05, 1e-4);
}

TEST(ContactLaws, BodiesWinOverMaterialsAndThoseOverTheDefault) {
  Scene scene;
  for (const char* name : {"a", "b", "c"}) {
    BodyDescription description;
    description.name = name;
    description.material = std::string(name) == "c" ? "" : "rubber";
    scene.bodies.push_back(description);
  }
  scene.contact.friction = 0.1;
  scene.contact.pairs = {
      {"rubber", "rubber", 0.2, 0.0}, {"walls", "rubber", 0.3, 0.0}, {"b", "a", 0.4, 0.5}, {"rubber", "c", 0.6, 0.0}};
  const ContactLaws laws(scene);
  EXPECT_EQ(laws.of(0, 1).friction, 0.4);
  EXPECT_EQ(laws.of(1, 0).restitution, 0.5);
  EXPECT_EQ(laws.of(0, Contact::kWall).friction, 0.3);
  EXPECT_EQ(laws.of(0, 2).friction, 0.6);
  EXPECT_EQ(laws.of(2, Contact::kWall).friction, 0.1);
}

// A liquid that is hardly viscous moves a body as one without viscosity does, which has no stress block.
TEST(ModelSelection, LeavingOutTheStressBlockChangesTheAnswerByNoMoreThanItsSize) {
  Scene scene = slope(0.0, true);
  scene.bodies[0].X_WB.translation()[2] = 0.15;
  scene.solver.tolerance = 1e-9;
  scene.solver.time_stepping = TimeStepping::kBackwardEuler;  // a single solve: later ones follow what slips past walls
  Scene inviscid = scene;
  inviscid.liquid.dynamic_viscosity = 0.0;
  scene.liquid.dynamic_viscosity = 1e-10;
  Simulation a(scene), b(inviscid);
  const StepReport with = a.step(), without = b.step();
  ASSERT_TRUE(with.committed() && without.committed());
  EXPECT_TRUE(with.model.viscosity);
  EXPECT_FALSE(without.model.viscosity);
  EXPECT_LT((a.bodies()[0].twist - b.bodies()[0].twist).norm(), 1e-6 * b.bodies()[0].twist.norm());
}

// What lands on another body in water stands on it: no film of a hundredth of a cell carries it, no pocket in the gap
// holds it down. The gap lies on faces of the grid.
TEST(Contact, ABoxThatSinksOntoASlabStandsOnIt) {
  constexpr double kCell = 0.02, kLiquid = 1000.0, kGravity = 9.81;
  const Eigen::Vector3d size(0.12, 0.1, 0.08);
  const struct {
    double angle;
    Eigen::Vector3d axis;
    double aside;
  } poses[] = {{0.3, {1.0, 2.0, 0.5}, 0.0}, {0.8, {1.0, 2.0, 0.5}, 0.008}, {0.8, {1.0, 0.0, 0.3}, 0.015}};
  for (const auto& pose : poses) {
    Scene scene;
    scene.source = "test";
    scene.tank.size = {0.4, 0.4, 0.4};
    scene.tank.cell_width = kCell;
    scene.liquid.density = kLiquid;
    scene.liquid.dynamic_viscosity = 0.001;
    scene.liquid.fill_level = 0.32;
    scene.time_step = 0.02;
    scene.contact.friction = 0.4;
    scene.bodies = {boxBody("box", size, 2500.0, {0.2 + pose.aside, 0.203, 0.22}),
                    boxBody("slab", {0.2, 0.2, 0.06}, 3000.0, {0.2, 0.2, 0.03})};
    scene.bodies[0].X_WB.rotate(Eigen::AngleAxisd(pose.angle, pose.axis.normalized()));
    Simulation simulation(scene);
    const double buoyancy = kLiquid * kGravity * size.prod(), weight = kGravity * scene.bodies[0].mass;
    int iterations = 0;
    for (int i = 0; i < 150; ++i) {
      const StepReport report = simulation.step();
      ASSERT_TRUE(report.committed()) << report.message;
      iterations += report.iterations;
      if (i < 100) continue;
      const BodyState box = simulation.bodyStates()[0];
      EXPECT_NEAR(box.liquid.force[2], buoyancy, 0.02 * weight) << pose.angle << ", " << report.time;
      EXPECT_NEAR(box.contact.force[2], weight - buoyancy, 0.02 * weight) << pose.angle << ", " << report.time;
    }
    EXPECT_LT(iterations, 1500) << pose.angle;
  }
}

// Two bodies in a dry tank without gravity: `first` comes from the left at 1 m/s, or does not move; `second` is at
// rest.
Scene meeting(BodyDescription first, BodyDescription second) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = {2.0, 1.0, 1.0};
  scene.tank.cell_width = 0.05;
  scene.gravity.setZero();
  scene.time_step = 0.02;
  scene.bodies = {std::move(first), std::move(second)};
  return scene;
}

// Nothing acts on the bodies but the contact.
TEST(Contact, ABodyThatIsPushedWhereNothingElseActsGoesAlong) {
  BodyDescription pusher = boxBody("pusher", {0.2, 0.2, 0.2}, 1000.0, {0.5, 0.5, 0.5});
  pusher.motion = BodyMotion::kPrescribed;
  pusher.prescribed.twist[0] = 0.1;
  for (const SolverName solver : {SolverName::kFast, SolverName::kDirect, SolverName::kReference}) {
    Scene scene = meeting(pusher, boxBody("pushed", {0.2, 0.2, 0.2}, 1000.0, {0.702, 0.5, 0.5}));
    scene.solver.name = solver;
    Simulation simulation(scene);
    for (int i = 0; i < 10; ++i) {
      const StepReport r = simulation.step();
      ASSERT_TRUE(r.committed()) << r.message;
    }
    EXPECT_NEAR(simulation.bodyStates()[1].velocity[0], 0.1, 1e-3) << static_cast<int>(solver);
  }
}

// What is prescribed has its way, but the body that it leaves no room is not thrown aside by round-off.
TEST(Contact, ABodyThatIsJammedIsNotThrownAside) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = {0.4, 0.2, 0.2};
  scene.tank.origin.setZero();
  scene.tank.cell_width = 0.02;
  scene.time_step = 0.02;
  scene.bodies = {boxBody("box", {0.1, 0.08, 0.08}, 1500.0, {0.2, 0.1, 0.0401}),
                  boxBody("press", {0.04, 0.16, 0.16}, 1000.0, {0.1, 0.1, 0.1})};
  scene.bodies[1].motion = BodyMotion::kPrescribed;
  scene.bodies[1].prescribed.twist[0] = 0.2;
  Simulation simulation(scene);
  double furthest = 0.0;
  while (simulation.time() < 1.0) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    const BodyState box = simulation.bodyStates()[0];
    furthest = std::max(furthest, box.X_WB.translation()[0]);
    EXPECT_LT(box.velocity.tail<2>().norm(), 0.01) << simulation.time();
  }
  EXPECT_NEAR(furthest, 0.35, 1e-3) << "it is pushed to the wall";
}

// A contact that did not go along with what rolls would push it on.
TEST(Contact, WhatRollsOnAnotherBodyKeepsItsSpeed) {
  constexpr double kRadius = 0.03, kSpeed = 0.02, kTop = 0.1;
  for (const TimeStepping scheme : {TimeStepping::kBdf2, TimeStepping::kBackwardEuler}) {
    for (const bool ball : {true, false}) {
      for (const bool fixed : {true, false}) {
        Scene scene;
        scene.source = "test";
        scene.tank.size = {0.6, 0.4, 0.3};
        scene.tank.cell_width = 0.05;
        scene.gravity = {0.0, 0.0, -9.81};
        scene.contact.friction = 0.5;
        scene.solver.time_stepping = scheme;
        scene.bodies.push_back(boxBody("table", {0.5, 0.3, kTop}, 20000.0, {0.3, 0.2, 0.5 * kTop}));
        if (fixed) scene.bodies[0].motion = BodyMotion::kFixed;
        const Eigen::Vector3d start(0.2, 0.2, kTop + kRadius);
        BodyDescription roller =
            ball ? sphereBody("roller", kRadius, 1000.0, start) : cylinderBody("roller", kRadius, 0.08, 1000.0, start);
        if (!ball) roller.X_WB.linear() = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
        roller.velocity = {kSpeed, 0.0, 0.0};
        roller.angular_velocity = {0.0, kSpeed / kRadius, 0.0};
        scene.bodies.push_back(roller);
        Simulation simulation(scene);
        for (int i = 0; i < 150; ++i) {
          const StepReport r = simulation.step();
          ASSERT_TRUE(r.committed()) << r.message;
        }
        EXPECT_NEAR(simulation.bodyStates()[1].velocity[0], kSpeed, 1e-4)
            << (ball ? "ball" : "cylinder") << (fixed ? ", fixed" : ", free");
      }
    }
  }
}

// The bar is at rest when contacts are looked for, and turns through the block within the step.
TEST(Contact, IsFoundWhereATorqueOnlyBeginsToTurnABody) {
  BodyDescription block = boxBody("block", {0.05, 0.2, 0.2}, 1000.0, {1.18, 0.5, 0.535});
  block.motion = BodyMotion::kFixed;
  Scene scene = meeting(boxBody("bar", {0.4, 0.05, 0.05}, 1000.0, {1.0, 0.5, 0.39}), block);
  Simulation simulation(scene);
  ASSERT_TRUE(simulation.step().committed());  // in parts, of which each would look anew
  Wrench turn;
  turn.torque[1] = -1500.0 * scene.bodies[0].inertia_Bcm(1, 1);
  simulation.setWrench(0, turn);
  int contacts = 0;
  double penetration = 0.0;
  for (int i = 0; i < 5; ++i) {
    const StepReport r = simulation.step();
    if (!r.committed()) break;  // it says so
    contacts = std::max(contacts, r.model.contacts);
    penetration = std::max(penetration, r.penetration);
  }
  EXPECT_GT(contacts, 0);
  EXPECT_LT(penetration, 0.5 * scene.tank.cell_width);
}

// How fast it takes back what it is inside another does not depend on the step, and hardly stays.
TEST(Contact, ABodySetIntoTheFloorRisesWithoutAJump) {
  for (const double dt : {0.0005, 0.002, 0.02}) {
    Scene scene = meeting(boxBody("box", {0.2, 0.2, 0.2}, 1000.0, {1.0, 0.5, 0.1}),
                          boxBody("far", {0.1, 0.1, 0.1}, 1000.0, {0.3, 0.5, 0.5}));
    scene.gravity = {0.0, 0.0, -9.81};
    scene.time_step = dt;
    Simulation simulation(scene);
    simulation.setBodyState(0, Eigen::Isometry3d(Eigen::Translation3d(1.0, 0.5, 0.099)), Eigen::Vector3d::Zero(),
                            Eigen::Vector3d::Zero());
    double highest = 0.0;
    while (simulation.time() < 0.2) {
      ASSERT_TRUE(simulation.step().committed());
      highest = std::max(highest, simulation.bodyStates()[0].X_WB.translation()[2]);
    }
    EXPECT_LT(highest, 0.1 + 3e-4) << dt;
  }
}

// What overlaps is pushed apart, and without gravity the speed that it takes stays: bodies start side by side.
TEST(Contact, BodiesThatOverlapAtTheStartAreRefused) {
  for (const double depth : {0.0, 1e-5, 1e-3}) {  // of 1 m, cells of 0.05 m
    const Scene scene = meeting(boxBody("left", {0.2, 0.2, 0.2}, 1000.0, {0.8, 0.5, 0.5}),
                                boxBody("right", {0.2, 0.2, 0.2}, 1000.0, {1.0 - depth, 0.5, 0.5}));
    if (depth > 1e-4) {
      EXPECT_THROW(Simulation{scene}, SceneError) << depth;
      continue;
    }
    Simulation simulation(scene);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
    EXPECT_LT(std::abs(simulation.bodyStates()[1].velocity[0]), 0.5 * depth / 0.02 + 1e-9) << depth;
  }
}

// Poses are those of the images in the tank, so that bodies meet in it however far they have come.
TEST(Contact, IsThereAfterALapAlongAPeriodicAxis) {
  BodyDescription ball = sphereBody("ball", 0.1, 1000.0, {0.5, 0.5, 0.5});
  ball.velocity[0] = 1.0;
  BodyDescription post = boxBody("post", {0.1, 0.1, 0.9}, 1000.0, {0.2, 0.5, 0.5});
  post.motion = BodyMotion::kFixed;
  Scene scene = meeting(ball, post);
  scene.tank.periodic[0] = true;
  Simulation simulation(scene);
  bool met = false;
  while (simulation.time() < 2.0) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    const double x = simulation.bodyStates()[0].X_WB.translation()[0];
    EXPECT_GE(x, 0.0);
    EXPECT_LE(x, 2.0);
    met = met || simulation.bodyStates()[0].contact.force.norm() > 0.0;
  }
  EXPECT_TRUE(met);
  EXPECT_LT(simulation.bodyStates()[0].velocity[0], 0.01);
}

// Any image of a pose may be set; what is asked for is the velocity of the body's origin there.
TEST(Contact, ABodyMayBeSetInAnotherImageOfAPeriodicTank) {
  Scene scene = meeting(boxBody("box", {0.2, 0.2, 0.2}, 1000.0, {0.5, 0.5, 0.5}),
                        boxBody("far", {0.1, 0.1, 0.1}, 1000.0, {1.5, 0.5, 0.5}));
  scene.tank.periodic[0] = true;
  Simulation simulation(scene);
  simulation.setBodyState(0, Eigen::Isometry3d(Eigen::Translation3d(-1.3, 0.5, 0.5)), {0.1, 0.0, 0.0}, {0.0, 0.0, 2.0});
  const BodyState box = simulation.bodyStates()[0];
  EXPECT_NEAR(box.X_WB.translation()[0], 0.7, 1e-12);
  EXPECT_LT((box.velocity - Eigen::Vector3d(0.1, 0.0, 0.0)).norm(), 1e-12);
}

}  // namespace
}  // namespace monolith
