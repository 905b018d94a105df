// Liquid in gaps of less than a cell, and contacts that it has left.

#include <gtest/gtest.h>

#include <utility>

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

// How far, in cells, a box rises in some steps that leaves `gap` cells of a full tank on all sides, and what then
// carries it, in its displaced weight.
std::pair<double, double> riseInFullTank(double viscosity, double gap, double density, int steps) {
  Scene scene = fullTank(viscosity);
  const Eigen::Vector3d side = scene.tank.size - 2.0 * gap * kCell * Eigen::Vector3d::Ones();
  scene.bodies.push_back(boxBody("box", side, density, 0.5 * scene.tank.size));
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulation.step().committed());
  const BodyState box = simulation.bodyStates()[0];
  const double displaced = scene.liquid.density * side.prod() * scene.gravity.norm();
  return {(box.X_WB.translation() - 0.5 * scene.tank.size).z() / kCell, box.liquid.force.z() / displaced};
}

// Nothing of the liquid is open by itself then. In one step a body that nothing carries would fall by 0.1 cells and
// have met the floor.
TEST(NarrowGap, CarriesABodyThatAllButFillsTheTank) {
  for (const double viscosity : {2.0, 100.0}) {
    for (const double gap : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      const auto [neutral, carried] = riseInFullTank(viscosity, gap, 1000.0, 5);
      EXPECT_NEAR(neutral, 0.0, 1e-6) << viscosity << " " << gap;
      EXPECT_NEAR(carried, 1.0, 1e-6) << viscosity << " " << gap;
      for (const double density : {500.0, 1500.0}) {
        const double first = riseInFullTank(viscosity, gap, density, 1).first;
        const auto [rise, carries] = riseInFullTank(viscosity, gap, density, 5);
        const double direction = density < 1000.0 ? 1.0 : -1.0;
        EXPECT_GE(direction * first, 0.0) << viscosity << " " << gap << " " << density;
        EXPECT_GE(direction * rise, direction * first) << viscosity << " " << gap << " " << density;
        EXPECT_LT(direction * rise, 0.1 / viscosity) << viscosity << " " << gap << " " << density;
        EXPECT_NEAR(carries, density / 1000.0, 0.02) << viscosity << " " << gap << " " << density;
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
