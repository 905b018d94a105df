// Balls and cylinders that float: what they are not driven or turned by.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kCell = 0.02;
constexpr double kLevel = 0.24;

Scene pool(const Vector3d& cells) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = kCell * cells;
  scene.tank.cell_width = kCell;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 0.001;
  scene.liquid.fill_level = kLevel;
  scene.time_step = 0.02;
  return scene;
}

// Five cells across. In a tank that is periodic sideways nothing pushes it to any side.
TEST(Floating, ABallThatBobsStaysAtItsPlace) {
  constexpr double kRadius = 0.05;
  constexpr double kOffset = 0.4;  // cells, from a place at which the grid is symmetric
  Scene scene = pool({20, 20, 20});
  scene.tank.periodic[0] = scene.tank.periodic[1] = true;
  const Vector3d start(0.2 + kOffset * kCell, 0.2 + kOffset * kCell, kLevel + 0.03);
  scene.bodies = {sphereBody("ball", kRadius, 200.0, start)};
  Simulation simulation(scene);
  double farthest = 0.0, fastest = 0.0;
  while (simulation.time() < 4.0) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    const BodyState ball = simulation.bodyStates()[0];
    farthest = std::max(farthest, (ball.X_WB.translation() - start).head<2>().norm());
    fastest = std::max(fastest, ball.angular_velocity.norm());
  }
  EXPECT_LT(farthest, 0.4 * kCell);
  EXPECT_LT(fastest, 0.25);
}

TEST(Floating, AWaveThatPassesABallDoesNotSpinIt) {
  Scene scene = pool({40, 20, 24});
  scene.time_step = 0.01;
  scene.liquid.fill_level = 0.2;
  scene.liquid.boxes = {Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(0.3, 0.4, 0.28))};
  scene.bodies = {sphereBody("ball", 0.05, 200.0, {0.503, 0.207, 0.23})};
  Simulation simulation(scene);
  double fastest = 0.0;
  while (simulation.time() < 1.0) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    fastest = std::max(fastest, simulation.bodyStates()[0].angular_velocity.norm());
  }
  EXPECT_LT(fastest, 0.15);
}

// All that acts on a ball acts through its centre, on a cylinder through its axis, wherever the centre of mass is.
TEST(Floating, PressureTurnsNoBallAndNoCylinderAboutItsAxis) {
  for (const bool ball : {true, false}) {
    for (const double place : {0.1, 0.37, 0.8}) {
      Scene scene = pool({20, 20, 20});
      const Vector3d centre = Vector3d(0.2, 0.2, kLevel) + place * kCell * Vector3d(1.0, -0.7, 0.9);
      BodyDescription body =
          ball ? sphereBody("body", 0.05, 500.0, centre) : cylinderBody("body", 0.05, 0.16, 500.0, centre);
      body.X_WB.rotate(Eigen::AngleAxisd(1.1, Vector3d(0.3, 1.0, 0.2).normalized()));
      body.p_BBcm = Vector3d(0.01, -0.02, 0.005);
      body.motion = BodyMotion::kFixed;
      scene.bodies = {body};
      Simulation simulation(scene);
      for (int step = 0; step < 3; ++step) ASSERT_TRUE(simulation.step().committed());
      const Wrench liquid = simulation.bodyStates()[0].liquid;
      ASSERT_GT(liquid.force[2], 1.0);
      const Vector3d arm = body.X_WB.linear() * body.p_BBcm;
      Vector3d torque = liquid.torque + arm.cross(liquid.force);  // about the centre
      if (!ball) torque = Vector3d::UnitX() * torque.dot(body.X_WB.linear().col(2));
      EXPECT_LT(torque.norm(), 1e-5 * 0.05 * liquid.force.norm()) << (ball ? "ball " : "cylinder ") << place;
    }
  }
}

}  // namespace
}  // namespace monolith
