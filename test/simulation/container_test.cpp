// Liquid in containers whose walls are a few cells thick and less: it stays on its side of them, at rest and moved.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/scene_file.h"
#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kCell = 0.02;
constexpr double kInner = 0.24;  // m, width and height inside
constexpr double kFilled = 0.13;

Scene emptyTank(const Vector3d& cells, double viscosity) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = kCell * cells;
  scene.tank.cell_width = kCell;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = 0.02;
  return scene;
}

Shape box(const Vector3d& size, const Vector3d& position) {
  Shape shape = boxBody("part", size, 1000.0, Vector3d::Zero()).shapes[0];
  shape.X_BG = Eigen::Isometry3d(Eigen::Translation3d(position));
  return shape;
}

// Open at the top; the origin in the middle of its floor.
BodyDescription bucket(double wall, const Vector3d& position) {
  const double outer = kInner + 2.0 * wall, middle = 0.5 * (kInner + wall);
  BodyDescription body = boxBody("bucket", {outer, outer, wall}, 1000.0, position);
  body.shapes = {box({outer, outer, wall}, {0.0, 0.0, -0.5 * wall}),
                 box({wall, outer, kInner}, {middle, 0.0, 0.5 * kInner}),
                 box({wall, outer, kInner}, {-middle, 0.0, 0.5 * kInner}),
                 box({kInner, wall, kInner}, {0.0, middle, 0.5 * kInner}),
                 box({kInner, wall, kInner}, {0.0, -middle, 0.5 * kInner})};
  body.motion = BodyMotion::kFixed;
  return body;
}

// A bucket that stands `offset` cells beside the grid's faces and is filled to kFilled.
Scene filledBucket(double wall_cells, double offset, double viscosity) {
  Scene scene = emptyTank({32, 24, 24}, viscosity);
  const Vector3d at = Vector3d(0.32, 0.24, 0.12) + Vector3d::Constant(offset * kCell);
  const Vector3d half(0.5 * kInner, 0.5 * kInner, 0.0);
  scene.liquid.boxes = {Eigen::AlignedBox3d(at - half, at + half + Vector3d(0.0, 0.0, kFilled))};
  scene.bodies = {bucket(wall_cells * kCell, at)};
  return scene;
}

struct Contents {
  double level = 0.0;  // m above the bucket's floor, mean
  int outside = 0;     // points of the surface that are not in it
};

Contents contents(const Simulation& simulation, double wall) {
  const Eigen::Isometry3d X_BW = simulation.bodyStates()[0].X_WB.inverse();
  Contents out;
  int inside = 0;
  for (const SurfacePoint& point : simulation.surfacePoints()) {
    const Vector3d p = X_BW * point.position.cast<double>();
    const bool in = p.head<2>().cwiseAbs().maxCoeff() < 0.5 * (kInner + wall) && p[2] > -0.5 * wall;
    inside += in;
    out.outside += !in;
    if (in) out.level += p[2];
  }
  out.level /= std::max(inside, 1);
  return out;
}

// Largest speed in the last second.
double run(Simulation& simulation, double end) {
  double fastest = 0.0;
  while (simulation.time() < end) {
    const StepReport report = simulation.step();
    EXPECT_TRUE(report.committed()) << report.message;
    if (!report.committed()) break;
    if (simulation.time() > end - 1.0) fastest = std::max(fastest, report.maximum_speed);
  }
  return fastest;
}

TEST(Container, HoldsItsLiquidStill) {
  struct Wall {
    double cells, offset, viscosity;
  };
  for (const Wall& wall : {Wall{1.5, 0.0, 0.01}, Wall{1.5, 0.3, 0.01}, Wall{2.0, 0.0, 0.01}, Wall{2.0, 0.3, 0.01},
                           Wall{3.0, 0.0, 0.01}, Wall{3.0, 0.3, 0.01}, Wall{2.0, 0.3, 0.0}}) {
    Simulation simulation(filledBucket(wall.cells, wall.offset, wall.viscosity));
    EXPECT_LT(run(simulation, 2.0), 2e-3) << wall.cells << " " << wall.offset << " " << wall.viscosity;
    const Contents now = contents(simulation, wall.cells * kCell);
    EXPECT_EQ(now.outside, 0) << wall.cells << " " << wall.offset;
    EXPECT_NEAR(now.level, kFilled, 0.1 * kCell) << wall.cells << " " << wall.offset;
  }
}

TEST(Container, HoldsItsLiquidWhileItIsMoved) {
  struct Motion {
    int component;
    double twist, amplitude;
  };
  for (const double viscosity : {0.01, 2.0}) {
    for (const Motion& motion :
         {Motion{0, 0.0, 0.03}, Motion{2, 0.01, 0.0}, Motion{4, 0.0, 0.2}, Motion{5, 0.0, 0.4}}) {
      Scene scene = filledBucket(2.0, 0.3, viscosity);
      PrescribedMotion& prescribed = scene.bodies[0].prescribed;
      scene.bodies[0].motion = BodyMotion::kPrescribed;
      prescribed.twist[motion.component] = motion.twist;
      prescribed.amplitude[motion.component] = motion.amplitude;
      prescribed.frequency = 0.5;
      Simulation simulation(scene);
      run(simulation, 2.0);
      const Contents now = contents(simulation, 2.0 * kCell);
      EXPECT_EQ(now.outside, 0) << viscosity << " " << motion.component;
      EXPECT_NEAR(now.level, kFilled, 0.15 * kCell) << viscosity << " " << motion.component;
    }
  }
}

// The corner that turns through the cells beside it opens some by next to nothing: no liquid is shot out of these.
TEST(Container, ThatTurnsShootsNoLiquidAbout) {
  constexpr double kSpin = 2.0;
  Scene scene = filledBucket(3.0, 0.0, 0.001);
  scene.bodies[0].motion = BodyMotion::kPrescribed;
  scene.bodies[0].prescribed.twist[5] = kSpin;
  Simulation simulation(scene);
  const double corner = kSpin * std::sqrt(0.5) * kInner;
  while (simulation.time() < 2.5) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    EXPECT_LT(report.maximum_speed, 5.0 * corner) << report.time;
  }
}

// Without viscosity the velocity within the walls is not theirs: the level set there is not carried along.
TEST(Container, CarriesInviscidLiquidAlong) {
  Scene scene = filledBucket(5.0, 0.3, 0.0);
  const Vector3d velocity(0.3, 0.0, 0.0), aside(-0.08, 0.0, 0.0);
  scene.bodies[0].X_WB.pretranslate(aside);
  scene.liquid.boxes[0].translate(aside);
  scene.bodies[0].motion = BodyMotion::kPrescribed;
  scene.bodies[0].prescribed.twist.head<3>() = velocity;
  Simulation simulation(scene);
  simulation.setLiquidVelocity([&](const Vector3d&) { return velocity; });
  double corrected = 0.0;
  while (simulation.time() < 0.5) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    corrected = std::max(corrected, std::abs(report.volume_correction) / report.liquid_volume);
    EXPECT_LT(report.maximum_speed, 1.2 * velocity[0]);
  }
  EXPECT_LT(corrected, 1e-3);
  const Contents now = contents(simulation, 5.0 * kCell);
  EXPECT_EQ(now.outside, 0);
  EXPECT_NEAR(now.level, kFilled, 0.1 * kCell);
}

// Left a column collapses against a wall, behind which a pool of some depth is still.
Scene divided(double wall_cells, double offset, double behind) {
  Scene scene = emptyTank({24, 10, 20}, 0.01);
  scene.liquid.fill_level = behind;
  const double left = (10.0 + offset) * kCell, width = wall_cells * kCell;
  scene.liquid.boxes = {Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(0.08, 0.2, 0.3)),
                        Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(left, 0.2, 0.12))};
  scene.bodies = {boxBody("wall", {width, 0.2, 0.4}, 1000.0, {left + 0.5 * width, 0.1, 0.2})};
  scene.bodies[0].motion = BodyMotion::kFixed;
  return scene;
}

TEST(Container, AWallOfTwoCellsKeepsASplashFromWhatIsBehindIt) {
  for (const double behind : {0.0, 0.07}) {
    for (const double offset : {0.0, 0.4}) {
      Simulation simulation(divided(2.0, offset, behind));
      run(simulation, 3.0);
      double level = 0.0, highest = 0.0;
      int points = 0;
      for (const SurfacePoint& point : simulation.surfacePoints()) {
        if (point.position[0] < (12.0 + offset) * kCell) continue;
        level += point.position[2];
        highest = std::max<double>(highest, point.position[2]);
        ++points;
      }
      if (behind == 0.0) {
        EXPECT_EQ(points, 0) << offset;
        continue;
      }
      EXPECT_NEAR(level / points, behind, 0.05 * kCell) << offset;
      EXPECT_LT(highest, behind + 0.5 * kCell) << offset;
    }
  }
}

// What splashed on a wall that lies on the grid's faces comes down again: it does not stay there as half a cell of the
// level set that no velocity moves.
TEST(Container, NoFilmStaysOnAWall) {
  Simulation simulation(divided(4.0, 0.0, 0.0));
  double highest = 0.0;
  run(simulation, 8.0);
  for (const SurfacePoint& point : simulation.surfacePoints()) {
    highest = std::max<double>(highest, point.position[2]);
  }
  EXPECT_LT(highest, 0.3);
}

TEST(Container, WhatTheGridDoesNotResolveIsTold) {
  const auto warnings = [](const Scene& scene) { return Simulation(scene).warnings(); };
  EXPECT_TRUE(warnings(filledBucket(1.0, 0.3, 0.01)).empty());
  const auto leaky = warnings(filledBucket(0.5, 0.3, 0.01));
  ASSERT_EQ(leaky.size(), 1U);
  EXPECT_NE(leaky[0].find("test: body 'bucket': walls of 0.01"), std::string::npos) << leaky[0];
  EXPECT_NE(leaky[0].find("liquid passes through them; expected at least 1 cell"), std::string::npos) << leaky[0];
  Scene small = filledBucket(2.0, 0.0, 0.01);
  small.bodies = {sphereBody("ball", 0.025, 500.0, {0.3, 0.2, 0.2})};
  const auto rough = warnings(small);
  ASSERT_EQ(rough.size(), 1U);
  EXPECT_NE(rough[0].find("body 'ball': 0.05 m, 2.5 cells"), std::string::npos) << rough[0];
  small.liquid.boxes.clear();
  EXPECT_TRUE(warnings(small).empty()) << "nothing depends on cells without liquid";
  for (const std::string name : {"arm", "drop", "settling_sphere", "stack"}) {
    const std::string file = std::string(MONOLITH_SOURCE_DIR) + "/config/scenes/" + name + ".yaml";
    for (const std::string& warning : warnings(loadScene(file, {}))) ADD_FAILURE() << warning;
  }
}

}  // namespace
}  // namespace monolith
