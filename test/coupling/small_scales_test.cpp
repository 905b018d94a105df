// What the grid does not resolve, bodies smaller than a cell and gaps below one, neither locks nor leaks.

#include <gtest/gtest.h>

#include <cmath>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr double kWidth = 0.01;  // of a cell, m
constexpr double kGravity = 9.81;

// A cube of 12 cells, its corner at the origin.
Scene tank(double fill_level, double viscosity, Discretisation discretisation) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = Eigen::Vector3d::Constant(12.0 * kWidth);
  scene.tank.cell_width = kWidth;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = fill_level;
  scene.time_step = 0.01;
  scene.solver.discretisation = discretisation;
  return scene;
}

// Steps, and holds each to what holds of every one. False: it failed.
bool advance(Simulation& simulation, double until) {
  double volume = simulation.report().liquid_volume;
  while (simulation.time() < until - 1e-9) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
    if (!r.committed()) return false;
    if (!(volume > 0.0)) volume = r.liquid_volume;
    EXPECT_NEAR(r.liquid_volume, volume, 1e-3 * volume);
    EXPECT_LT(r.divergence * simulation.scene().time_step, 1e-3);
    EXPECT_LT(r.penetration, 0.1 * kWidth);
    for (const BodyState& body : simulation.bodyStates()) {
      EXPECT_TRUE(body.X_WB.matrix().allFinite() && body.velocity.allFinite() && body.angular_velocity.allFinite());
    }
  }
  return true;
}

class SmallScales : public testing::TestWithParam<Discretisation> {};

TEST_P(SmallScales, BodiesSmallerThanACellSinkAndRise) {
  for (const double viscosity : {0.0, 1.0}) {
    for (const double diameter : {0.3, 0.6, 0.9}) {
      for (const double ratio : {0.1, 8.0}) {
        SCOPED_TRACE(testing::Message() << viscosity << " Pa s, " << diameter << " h, ratio " << ratio);
        Scene scene = tank(9.3 * kWidth, viscosity, GetParam());
        const Eigen::Vector3d start(0.0613, 0.0582, 0.0571);
        scene.bodies.push_back(sphereBody("ball", 0.5 * diameter * kWidth, 1000.0 * ratio, start));
        Simulation simulation(scene);
        if (!advance(simulation, 0.05)) continue;
        const double moved = simulation.bodyStates()[0].X_WB.translation()[2] - start[2];
        EXPECT_GT(ratio < 1.0 ? moved : -moved, 1e-5);
        // So small a body may miss the added mass of half of what it displaces, but feels no more than its buoyancy.
        EXPECT_LT(std::abs(moved), 0.55 * std::abs(1.0 / ratio - 1.0) * kGravity * 0.05 * 0.05);
      }
    }
  }
}

TEST_P(SmallScales, AGapBelowACellClosesUnderWeight) {
  for (const double viscosity : {0.0, 1.0}) {
    SCOPED_TRACE(viscosity);
    Scene scene = tank(12.0 * kWidth, viscosity, GetParam());
    const double gap = 0.3 * kWidth;
    scene.bodies = {boxBody("low", {0.05, 0.05, 0.03}, 3000.0, {0.061, 0.058, 0.0372}),
                    boxBody("high", {0.04, 0.04, 0.03}, 8000.0, {0.061, 0.058, 0.0672 + gap})};
    scene.bodies[0].motion = BodyMotion::kFixed;
    Simulation simulation(scene);
    const double top = 0.0522;
    double last = gap;
    for (double time = 0.01; time < 0.3; time += 0.01) {
      if (!advance(simulation, time)) break;
      const double now = simulation.bodyStates()[1].X_WB.translation()[2] - 0.015 - top;
      EXPECT_LT(now, last + 0.01 * kWidth);  // never back up
      last = now;
    }
    EXPECT_LT(last, 0.5 * gap);
  }
}

// A piston with a fifth of a cell to the walls: what it pushes away has to pass there.
TEST_P(SmallScales, APistonWithThinGapsIsHeldUpByTheLiquidBelow) {
  for (const double viscosity : {0.0, 1.0}) {
    SCOPED_TRACE(viscosity);
    Scene scene = tank(12.0 * kWidth, viscosity, GetParam());
    scene.bodies = {boxBody("piston", {0.116, 0.116, 0.03}, 3000.0, {0.06, 0.06, 0.0653})};
    Simulation simulation(scene);
    if (!advance(simulation, 0.05)) continue;
    const double fallen = 0.0653 - simulation.bodyStates()[0].X_WB.translation()[2];
    EXPECT_GE(fallen, -1e-9);
    EXPECT_LT(fallen, 0.2 * 0.5 * kGravity * 0.05 * 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Discretisations, SmallScales,
                         testing::Values(Discretisation::kFitted, Discretisation::kFractions), [](const auto& info) {
                           return info.param == Discretisation::kFitted ? "Fitted" : "Fractions";
                         });

}  // namespace
}  // namespace monolith
