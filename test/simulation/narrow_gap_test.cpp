// Liquid in gaps of less than a cell, and contacts that it has left.

#include <gtest/gtest.h>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr double kCell = 0.02;  // m
constexpr double kSide = 4.0 * kCell;

Scene fullTank(double viscosity) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = kCell * Eigen::Vector3d(10.0, 10.0, 14.0);
  scene.tank.cell_width = kCell;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = scene.tank.size[2];
  return scene;
}

// Height of a cube's centre, in cells, after `steps` above a fixed one whose top is at `top`.
double height(double viscosity, double top, double gap, double density, int steps) {
  Scene scene = fullTank(viscosity);
  const Eigen::Vector3d middle(5.0 * kCell, 5.0 * kCell, 0.0), up = kCell * Eigen::Vector3d::UnitZ();
  scene.bodies.push_back(boxBody("block", {kSide, kSide, kSide}, 2000.0, middle + (top - 2.0) * up));
  scene.bodies.back().motion = BodyMotion::kFixed;
  scene.bodies.push_back(boxBody("cube", {kSide, kSide, kSide}, density, middle + (top + gap + 2.0) * up));
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
  }
  return simulation.bodyStates()[1].X_WB.translation()[2] / kCell;
}

// The viscosities are on both sides of stickingViscosity().
TEST(NarrowGap, ClosesAndOpensAtAnyPlaceInTheGrid) {
  for (const double viscosity : {0.5, 1.4}) {
    for (const double top : {4.0, 4.3, 4.75}) {
      for (const double gap : {0.3, 0.6}) {
        EXPECT_NEAR(height(viscosity, top, gap, 7800.0, 20), top + 2.0, 0.05) << viscosity << " " << top << " " << gap;
        EXPECT_GT(height(viscosity, top, gap, 20.0, 8), top + gap + 2.5) << viscosity << " " << top << " " << gap;
      }
    }
  }
}

// No direction along a contact, and none around it, comes before another.
TEST(NarrowGap, ALightBoxRisesStraightFromWhereItLies) {
  for (const double viscosity : {0.001, 1.4}) {
    for (int axis = 0; axis < 3; ++axis) {
      Scene scene = fullTank(viscosity);
      scene.tank.size.setConstant(10.0 * kCell);
      scene.liquid.fill_level = scene.tank.size[2];
      scene.gravity = -9.81 * Eigen::Vector3d::Unit(axis);
      Eigen::Vector3d place = 0.5 * scene.tank.size;
      place[axis] = 0.5 * kSide;
      scene.bodies.push_back(boxBody("box", {kSide, kSide, kSide}, 100.0, place));
      Simulation simulation(scene);
      for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulation.step().committed());
      BodyState box = simulation.bodyStates()[0];
      const double speed = box.velocity[axis];
      EXPECT_GT(speed, 0.02) << viscosity << " " << axis;
      box.velocity[axis] = 0.0;
      EXPECT_LT(box.velocity.norm(), 1e-3 * speed) << viscosity << " " << axis;
      EXPECT_LT(0.5 * kSide * box.angular_velocity.norm(), 1e-3 * speed) << viscosity << " " << axis;
    }
  }
}

}  // namespace
}  // namespace monolith
