// Bodies and periodic boundaries: a body that crosses one, bodies that touch across one, one that spans the tank, one
// whose surface runs in place.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

BodyDescription spinningSphere(const Vector3d& position) {
  BodyDescription body;
  body.name = "sphere";
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = 0.2;
  body.shapes = {shape};
  body.X_WB.translation() = position;
  body.motion = BodyMotion::kPrescribed;
  body.prescribed.twist << 0.1, 0.0, 0.0, 0.0, 0.3, 1.0;
  body.prescribed.in_place = true;
  return body;
}

Scene periodicScene() {
  Scene scene;
  scene.tank.size = Vector3d::Ones();
  scene.tank.cell_width = 0.1;
  for (bool& periodic : scene.tank.periodic) periodic = true;
  scene.liquid.fill_level = 1.0;
  scene.liquid.density = 1.0;
  scene.liquid.dynamic_viscosity = 1.0;
  scene.gravity.setZero();
  scene.time_step = 0.1;
  scene.solver.tolerance = 1e-6;
  return scene;
}

Wrench wrenchOn(const Scene& scene) {
  Simulation simulation(scene);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(simulation.step().committed()) << simulation.report().message;
  return simulation.bodyStates()[0].liquid;
}

TEST(Periodic, ABodyThatCrossesTheBoundaryFeelsTheSame) {
  Scene scene = periodicScene();
  scene.bodies = {spinningSphere({0.52, 0.47, 0.5})};
  const Wrench inside = wrenchOn(scene);
  EXPECT_LT(inside.torque[2], -0.1);
  // By whole cells, and by whole periods.
  for (const Vector3d& shift : {Vector3d(0.5, 0.0, 0.0), Vector3d(0.4, 0.5, -0.5), Vector3d(2.0, -1.0, 3.5)}) {
    scene.bodies[0].X_WB.translation() = Vector3d(0.52, 0.47, 0.5) + shift;
    const Wrench across = wrenchOn(scene);
    EXPECT_LT((across.force - inside.force).norm(), 1e-4 * inside.force.norm()) << shift.transpose();
    EXPECT_LT((across.torque - inside.torque).norm(), 1e-4 * inside.torque.norm()) << shift.transpose();
  }
}

// A cube that drifts over the boundary against a bar on the other side.
TEST(Periodic, BodiesTouchAcrossTheBoundary) {
  for (const double speed : {0.1, 0.5}) {
    Scene scene = periodicScene();
    scene.tank.size = {0.4, 0.2, 0.2};
    scene.tank.cell_width = 0.02;
    scene.liquid.fill_level = 0.0;
    scene.time_step = 0.02;
    scene.bodies = {boxBody("bar", {0.2, 0.06, 0.06}, 1000.0, {0.1, 0.1, 0.1}),
                    boxBody("cube", {0.06, 0.06, 0.06}, 1000.0, {0.32, 0.1, 0.1})};
    scene.bodies[1].velocity = {speed, 0.0, 0.0};
    Simulation simulation(scene);
    const double bar = 0.72, cube = 0.216;  // kg
    const double energy = 0.5 * cube * speed * speed, together = speed * cube / (bar + cube);
    for (int i = 0; i < 100; ++i) {
      const StepReport report = simulation.step();
      ASSERT_TRUE(report.committed()) << report.message;
      EXPECT_LT(report.kinetic_energy, (1.0 + 1e-9) * energy);
      EXPECT_LT(report.penetration, 1e-4);
      const auto bodies = simulation.bodyStates();
      EXPECT_NEAR(bar * bodies[0].velocity[0] + cube * bodies[1].velocity[0], cube * speed, 1e-7 * cube * speed);
    }
    for (const BodyState& body : simulation.bodyStates()) EXPECT_NEAR(body.velocity[0], together, 1e-3 * together);
  }
}

// Blocks, balls and rollers that come down on each other: where the boundary cuts the pile makes no difference.
TEST(Periodic, APileIsTheSameAcrossTheBoundary) {
  for (const bool wet : {false, true}) {
    const auto settle = [&](const Vector3d& shift) {
      Scene scene = periodicScene();
      scene.tank.size = {0.4, 0.4, 0.4};
      scene.tank.cell_width = 0.025;
      scene.tank.periodic[2] = false;
      scene.liquid.fill_level = wet ? 0.2 : 0.0;
      scene.liquid.density = 1000.0;
      scene.gravity = {0.0, 0.0, -9.81};
      scene.time_step = 0.02;
      scene.solver.tolerance = 1e-7;
      scene.contact.friction = 0.5;
      scene.bodies = {boxBody("base", {0.2, 0.16, 0.1}, 2000.0, {0.2, 0.2, 0.05}),
                      boxBody("beam", {0.26, 0.08, 0.06}, 3000.0, {0.21, 0.19, 0.135}),
                      sphereBody("ball", 0.05, 4000.0, {0.18, 0.21, 0.22}),
                      cylinderBody("roller", 0.05, 0.1, 5000.0, {0.3, 0.22, 0.22})};
      for (BodyDescription& body : scene.bodies) body.X_WB.translation() += shift;
      Simulation simulation(scene);
      bool pushed = false;
      for (int i = 0; i < 15; ++i) {
        const StepReport report = simulation.step();
        EXPECT_TRUE(report.committed()) << report.message;
        pushed = pushed || simulation.bodyStates()[1].contact.force.norm() > 1.0;
      }
      EXPECT_TRUE(pushed);
      std::vector<Vector3d> positions;
      for (const BodyState& body : simulation.bodyStates()) {
        Vector3d x = body.X_WB.translation() - shift;
        for (int a = 0; a < 2; ++a) x[a] -= 0.4 * std::floor(x[a] / 0.4);
        positions.push_back(x);
      }
      return positions;
    };
    const std::vector<Vector3d> inside = settle(Vector3d::Zero());
    for (const Vector3d& shift : {Vector3d(0.2, 0.0, 0.0), Vector3d(0.2, 0.2, 0.0)}) {
      const std::vector<Vector3d> across = settle(shift);
      for (std::size_t b = 0; b < inside.size(); ++b) {
        EXPECT_LT((across[b] - inside[b]).norm(), wet ? 3e-5 : 1e-6) << b << (wet ? " wet" : " dry");
      }
    }
  }
}

TEST(Periodic, BodiesThatOverlapAcrossTheBoundaryAreRefused) {
  Scene scene = periodicScene();
  scene.source = "test";
  scene.bodies = {boxBody("left", {0.3, 0.3, 0.3}, 1.0, {0.05, 0.5, 0.5}),
                  boxBody("right", {0.3, 0.3, 0.3}, 1.0, {0.85, 0.5, 0.5})};
  const std::string expected = "bodies 'left' and 'right' overlap by 0.1 m, across the periodic boundary\n";
  try {
    Simulation simulation(scene);
    FAIL() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.what(), "test: bodies overlap at the start, expected them apart:\n" + expected);
  }
  scene.bodies[1].X_WB.translation()[0] = 0.7;
  Simulation simulation(scene);
  try {
    simulation.setBodyState(1, Eigen::Isometry3d(Eigen::Translation3d(-0.15, 0.5, 0.5)), Vector3d::Zero(),
                            Vector3d::Zero());
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
  }
}

// Where the centre of mass of a prescribed body lies changes nothing, also farther than half a period from its end.
TEST(Periodic, TheCentreOfMassOfAPrescribedBodyDoesNotMatter) {
  std::vector<Vector3d> torques;  // about the origin of the body's frame
  for (const double offset : {0.0, 0.1, 0.3}) {
    Scene scene = periodicScene();
    scene.bodies = {boxBody("bar", {0.7, 0.2, 0.2}, 1.0, {0.5, 0.5, 0.5})};
    scene.bodies[0].p_BBcm = {offset, 0.0, 0.0};
    scene.bodies[0].motion = BodyMotion::kPrescribed;
    scene.bodies[0].prescribed.twist << 0.0, 0.0, 0.0, 0.0, 0.6, 0.0;
    const Wrench liquid = wrenchOn(scene);
    torques.push_back(liquid.torque + Vector3d(offset, 0.0, 0.0).cross(liquid.force));
  }
  EXPECT_LT(torques[0][1], -0.01);
  for (const Vector3d& torque : torques) EXPECT_LT((torque - torques[0]).norm(), 1e-3 * torques[0].norm());
}

// A body and the liquid around it that move alike, turning about the body or not, go on as they are: also the liquid
// that sticks to the body.
TEST(Periodic, WhatMovesWithTheLiquidGoesOn) {
  const Vector3d velocity(0.3, 0.2, 0.1), spin(0.0, 0.0, 2.0);
  for (const bool turns : {false, true}) {
    Scene scene = periodicScene();
    scene.liquid.dynamic_viscosity = 1.0;
    scene.gravity.setZero();
    scene.time_step = 1e-3;
    scene.solver.tolerance = 1e-9;
    const Vector3d centre(0.52, 0.47, 0.5);
    scene.bodies = {sphereBody("ball", 0.3, 0.5, centre)};
    Simulation simulation(scene);
    simulation.setBodyState(0, Eigen::Isometry3d(Eigen::Translation3d(centre)), velocity,
                            turns ? spin : Vector3d::Zero());
    simulation.setLiquidVelocity([&](const Vector3d& x) -> Vector3d {
      return turns && (x - centre).norm() < 0.45 ? velocity + spin.cross(x - centre) : velocity;
    });
    ASSERT_TRUE(simulation.step().committed());
    const BodyState after = simulation.bodyStates()[0];
    // What turns ends in steps of cells.
    EXPECT_LT((after.velocity - velocity).norm(), turns ? 0.01 * velocity.norm() : 1e-8);
    EXPECT_LT((after.angular_velocity - (turns ? spin : Vector3d::Zero())).norm(), turns ? 0.02 * spin.norm() : 1e-8);
  }
}

// Along a periodic axis an odd number of cells leaves the pressure no coarser level.
TEST(Periodic, AnOddNumberOfCellsIsNotMuchSlower) {
  std::map<int, int> iterations;
  for (const int n : {32, 33}) {
    Scene scene = periodicScene();
    scene.tank.size = Vector3d::Constant(n);
    scene.tank.cell_width = 1.0;
    for (const int axis : {1, 2}) scene.tank.periodic[axis] = false;
    scene.liquid.fill_level = 0.6 * n;
    scene.liquid.dynamic_viscosity = 0.0;
    scene.gravity = {0.0, 0.0, -0.05};
    scene.time_step = 1.0;
    scene.bodies = {sphereBody("sphere", 0.15 * n, 1.5, Vector3d(0.3, 0.5, 0.4) * n)};
    Simulation simulation(scene);
    simulation.setLiquidVelocity(
        [&](const Vector3d& x) { return Vector3d(0.0, 0.0, 0.3 * std::sin(2.0 * M_PI * x[0] / n)); });
    const StepReport report = simulation.step();
    EXPECT_TRUE(report.committed()) << report.message;
    iterations[n] = report.iterations;
  }
  EXPECT_LT(iterations[33], 2 * iterations[32]);
}

// A plate that is longer than the tank's periods, anywhere between the grid's faces: Couette flow under it. Fractions
// are far off at this resolution, but the same everywhere along it and for any length.
TEST(Periodic, APlateThatSpansTheTankIsEndless) {
  const double depth = 0.76;
  for (const Discretisation discretisation : {Discretisation::kFitted, Discretisation::kFractions}) {
    std::vector<double> forces;
    for (const double length : {3.0, 4.0}) {
      Scene scene = periodicScene();
      scene.tank.periodic[2] = false;
      scene.solver.discretisation = discretisation;
      BodyDescription plate = spinningSphere({0.5, 0.5, 0.88});
      plate.shapes[0].kind = Shape::Kind::kBox;
      plate.shapes[0].box_size = {length, length, 0.24};
      plate.prescribed.twist << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
      scene.bodies = {plate};
      Simulation simulation(scene);
      for (int i = 0; i < 12; ++i) ASSERT_TRUE(simulation.step().committed());
      forces.push_back(-simulation.bodyStates()[0].liquid.force[0]);
      const double middle = simulation.liquidVelocity({0.5, 0.33, 0.35})[0];
      EXPECT_GT(middle, 0.1);
      for (const double x : {0.05, 0.95}) {
        EXPECT_NEAR(simulation.liquidVelocity({x, 0.66, 0.35})[0], middle, 1e-5) << length;
      }
      if (discretisation == Discretisation::kFitted) EXPECT_NEAR(middle, 0.35 / depth, 1e-3) << length;
    }
    EXPECT_NEAR(forces[0], forces[1], 1e-5 * forces[0]);
    if (discretisation == Discretisation::kFitted) EXPECT_NEAR(forces[0], 1.0 / depth, 2e-3);
  }
}

TEST(Periodic, ABodyThatRunsInPlaceStays) {
  Scene scene = periodicScene();
  scene.bodies = {spinningSphere({0.5, 0.5, 0.5})};
  Simulation simulation(scene);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
  const BodyState state = simulation.bodyStates()[0];
  EXPECT_EQ(state.X_WB.matrix(), scene.bodies[0].X_WB.matrix());
  EXPECT_DOUBLE_EQ(state.velocity[0], 0.1);
}

// A belt along the whole lid of a closed tank: its ends meet walls, where it neither takes liquid in nor gives it off.
TEST(Periodic, ABeltMovesNoLiquidThroughItsEnds) {
  Scene scene = periodicScene();
  for (bool& periodic : scene.tank.periodic) periodic = false;
  BodyDescription belt = spinningSphere({0.5, 0.5, 0.9});
  belt.shapes[0].kind = Shape::Kind::kBox;
  belt.shapes[0].box_size = {1.0, 1.0, 0.2};
  belt.prescribed.twist << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  scene.bodies = {belt};
  Simulation simulation(scene);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
  // Net flow through vertical sections.
  for (const double x : {0.1, 0.5, 0.9}) {
    double flux = 0.0, size = 0.0;
    for (int k = 0; k < 8; ++k) {
      for (int j = 0; j < 10; ++j) {
        const double u = simulation.liquidVelocity({x, 0.1 * j + 0.05, 0.1 * k + 0.05})[0];
        // Half a cell from belt and walls a part of the liquid of these faces sticks to them (sticking_liquid.h).
        const double kept = k == 7 ? 19.0 / 24.0 : k == 0 || j == 0 || j == 9 ? 11.0 / 12.0 : 1.0;
        const bool at_belt = k == 7 && j != 0 && j != 9;
        flux += kept * u + (at_belt ? 1.0 - kept : 0.0);
        size += std::abs(u);
      }
    }
    EXPECT_GT(size, 0.1);
    EXPECT_LT(std::abs(flux), 1e-4 * size) << x;
  }
}

}  // namespace
}  // namespace monolith
