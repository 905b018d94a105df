// The free surface, through whole simulations: nothing feeds it energy, and at rest it stays so.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

// Water in a tank of nx x ny x nz cells of width h, its corner at the origin.
Scene water(const Vector3d& cells, double h) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = h * cells;
  scene.tank.cell_width = h;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 0.001;
  scene.time_step = 0.02;
  return scene;
}

BodyDescription fixed(BodyDescription body, double pitch = 0.0) {
  body.motion = BodyMotion::kFixed;
  body.X_WB.rotate(Eigen::AngleAxisd(pitch, Vector3d::UnitY()));
  return body;
}

// Spray that falls below the grid's resolution comes back to the side that it was lost on.
TEST(Surface, APoolBehindAWallKeepsItsLevel) {
  Scene scene = water({24, 10, 20}, 0.02);
  scene.liquid.dynamic_viscosity = 0.01;
  scene.liquid.fill_level = 0.1;
  scene.liquid.boxes = {Eigen::AlignedBox3d(Vector3d(0.0, 0.0, 0.1), Vector3d(0.1, 0.2, 0.3))};
  scene.bodies = {fixed(boxBody("wall", {0.08, 0.2, 0.4}, 1000.0, {0.24, 0.1, 0.2}))};
  Simulation simulation(scene);
  const double volume = simulation.report().liquid_volume;
  double corrected = 0.0;
  while (simulation.time() < 2.0) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    EXPECT_NEAR(report.liquid_volume, volume, 1e-3 * volume);
    corrected += std::abs(report.volume_correction);
  }
  EXPECT_GT(corrected, 0.01 * volume) << "nothing was lost";
  double level = 0.0;
  int points = 0;
  for (const SurfacePoint& point : simulation.surfacePoints()) {
    if (point.position[0] < 0.28) continue;
    level += point.position[2];
    ++points;
  }
  EXPECT_NEAR(level / points, 0.1, 1e-4);
}

// Cells at the surface run dry and fill again all the time: what they begin with decides. Of the height at the start,
// the largest in the last quarter of 20 periods.
TEST(Surface, ShortWavesKeepTheirHeightWhereverTheSurfaceLiesInItsCells) {
  constexpr int kLength = 12;
  constexpr double kCell = 1.0 / kLength, kWaveNumber = 2.0 * M_PI;
  const double period = 2.0 * M_PI / std::sqrt(9.81 * kWaveNumber);
  for (const double level : {-0.1, 0.1, 0.3}) {
    for (const double height : {0.2, 0.5}) {
      Scene scene = water({kLength, 4, 16}, kCell);
      scene.liquid.dynamic_viscosity = 0.0;
      scene.tank.periodic[0] = scene.tank.periodic[1] = true;
      scene.time_step = 1.0 / 30.0;
      for (int i = 0; i < kLength; ++i) {
        const double low = i * kCell, crest = height * std::cos(kWaveNumber * (low + 0.5 * kCell));
        scene.liquid.boxes.emplace_back(Vector3d(low, 0.0, 0.0),
                                        Vector3d(low + kCell, 4.0 * kCell, (8.5 + level + crest) * kCell));
      }
      Simulation simulation(scene);
      const auto heightNow = [&] {
        double lowest = 1.0, highest = 0.0;
        for (const SurfacePoint& point : simulation.surfacePoints()) {
          lowest = std::min<double>(lowest, point.position[2]);
          highest = std::max<double>(highest, point.position[2]);
        }
        return 0.5 * (highest - lowest) / kCell;
      };
      double largest = 0.0;
      while (simulation.time() < 20.0 * period) {
        const StepReport report = simulation.step();
        ASSERT_TRUE(report.committed()) << report.message;
        if (simulation.time() > 15.0 * period) largest = std::max(largest, heightNow());
      }
      EXPECT_GT(largest, 0.75 * height) << level << ", " << height;
      EXPECT_LT(largest, 1.4 * height) << level << ", " << height;
    }
  }
}

// Free on all sides, across a periodic boundary, on a plate: the liquid is that of the box, from the start on.
TEST(Surface, ABoxOfLiquidHasTheVolumeOfTheBox) {
  for (const double offset : {0.0, 0.005, 0.01}) {
    for (const bool on_plate : {false, true}) {
      Scene scene = water({16, 16, 16}, 0.02);
      scene.tank.periodic[0] = true;
      const Vector3d low(0.3 + offset, 0.1 + offset, 0.12), size(0.08, 0.08, 0.08 + offset);
      const Vector3d kept(0.32 - low[0], size[1], size[2]);
      scene.liquid.boxes = {Eigen::AlignedBox3d(low, low + kept),
                            Eigen::AlignedBox3d(Vector3d(0.0, low[1], low[2]),
                                                Vector3d(size[0] - kept[0], low[1] + size[1], low[2] + size[2]))};
      if (on_plate) scene.bodies = {fixed(boxBody("plate", {0.28, 0.28, 0.12}, 1000.0, {0.0, 0.16, 0.06}))};
      Simulation simulation(scene);
      EXPECT_NEAR(simulation.report().liquid_volume, size.prod(), 0.02 * size.prod()) << offset << ", " << on_plate;
      for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
      EXPECT_NEAR(simulation.report().liquid_volume, size.prod(), 0.02 * size.prod()) << offset << ", " << on_plate;
    }
  }
}

// A box of liquid ends at a solid that it lies against, not at one that its surface is cut by.
TEST(Surface, ABoxOfLiquidAroundAFloatingBodyIsAsStillAsALevel) {
  Scene by_level = water({16, 16, 16}, 0.02);
  by_level.bodies = {sphereBody("ball", 0.06, 500.0, {0.16, 0.16, 0.16})};
  Scene by_box = by_level;
  by_level.liquid.fill_level = 0.16;
  by_box.liquid.boxes = {Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(0.32, 0.32, 0.16))};
  const double still = Simulation(by_level).step().maximum_speed;
  EXPECT_LT(still, 1e-3);
  EXPECT_LT(Simulation(by_box).step().maximum_speed, still + 1e-5);
}

// A jet rises along the far wall and falls back: thin sheets, in which no pressure holds the liquid back.
TEST(Surface, ADamThatBreaksGainsNoEnergy) {
  for (const double dt : {0.02, 0.005}) {
    Scene scene = water({32, 8, 20}, 0.0125);
    scene.time_step = dt;
    scene.liquid.boxes = {Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(0.12, 0.1, 0.15))};
    Simulation simulation(scene);
    const double energy = simulation.report().potential_energy;
    const double fall = std::sqrt(2.0 * 9.81 * 0.15);
    while (simulation.time() < 1.2) {
      const StepReport r = simulation.step();
      ASSERT_TRUE(r.committed()) << r.message;
      ASSERT_LT(r.kinetic_energy + r.potential_energy, 1.01 * energy) << dt << ", " << r.time;
      ASSERT_LT(r.maximum_speed, 4.0 * fall) << dt << ", " << r.time;
    }
  }
}

// Without surface tension nothing makes the surface meet a solid at an angle of its own.
TEST(Surface, StaysStillWhereSolidsSlantOutOfIt) {
  const std::vector<BodyDescription> solids = {
      fixed(sphereBody("high", 0.04, 500.0, {0.12, 0.12, 0.14})),
      fixed(sphereBody("low", 0.04, 500.0, {0.12, 0.12, 0.1})),
      fixed(boxBody("pitched", {0.08, 0.06, 0.1}, 500.0, {0.12, 0.12, 0.12}), 0.6)};
  for (const BodyDescription& solid : solids) {
    for (const double level : {0.12, 0.1237}) {
      Scene scene = water({24, 24, 24}, 0.01);
      scene.liquid.fill_level = level;
      scene.bodies = {solid};
      Simulation simulation(scene);
      for (int i = 0; i < 25; ++i) {
        const StepReport r = simulation.step();
        ASSERT_TRUE(r.committed()) << r.message;
        ASSERT_LT(r.maximum_speed, 1e-9) << solid.name << ", " << level << ", " << r.time;
      }
    }
  }
}

// The shortest waves would live for ever in steps as long as that.
TEST(Surface, APoolComesToRestWhateverTheOutputStep) {
  for (const double dt : {0.02, 0.1, 0.2}) {
    Scene scene = water({20, 4, 15}, 0.02);
    scene.time_step = dt;
    scene.liquid.dynamic_viscosity = 0.5;
    scene.liquid.boxes = {Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(0.2, 0.08, 0.22)),
                          Eigen::AlignedBox3d(Vector3d(0.2, 0.0, 0.0), Vector3d(0.4, 0.08, 0.2))};
    Simulation simulation(scene);
    double fastest = 0.0;
    while (simulation.time() < 6.0) {
      const StepReport report = simulation.step();
      ASSERT_TRUE(report.committed()) << report.message;
      if (simulation.time() > 5.0) fastest = std::max(fastest, report.maximum_speed);
    }
    EXPECT_LT(fastest, 0.01) << dt;
  }
}

TEST(Surface, ALightBallComesToRest) {
  Scene scene = water({20, 20, 24}, 0.01);
  scene.liquid.dynamic_viscosity = 0.1;
  scene.liquid.fill_level = 0.12;
  scene.bodies = {sphereBody("ball", 0.035, 100.0, {0.1, 0.1, 0.14})};
  Simulation simulation(scene);
  StepReport r;
  while (simulation.time() < 6.0) {
    r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
  }
  EXPECT_LT(r.maximum_speed, 0.02);
  EXPECT_LT(simulation.bodyStates()[0].velocity.norm(), 0.01);
}

// Where liquid ends at a periodic boundary, or lies across it, it is the same as any other.
TEST(Surface, ABoxOfLiquidFallsAtAPeriodicBoundaryAsItDoesElsewhere) {
  const auto box = [](double from, double to) {
    return Eigen::AlignedBox3d(Vector3d(from, 0.0, 0.0), Vector3d(to, 0.16, 0.2));
  };
  const std::vector<std::vector<Eigen::AlignedBox3d>> places = {
      {box(0.1, 0.3)}, {box(0.0, 0.2)}, {box(0.2, 0.4)}, {box(0.0, 0.1), box(0.3, 0.4)}};
  std::vector<double> energies;
  for (const auto& boxes : places) {
    Scene scene = water({20, 8, 16}, 0.02);
    scene.tank.periodic[0] = true;
    scene.liquid.boxes = boxes;
    Simulation simulation(scene);
    EXPECT_NEAR(simulation.report().liquid_volume, 0.2 * 0.16 * 0.2, 1e-3 * 0.2 * 0.16 * 0.2);
    while (simulation.time() < 0.1) ASSERT_TRUE(simulation.step().committed());
    energies.push_back(simulation.report().kinetic_energy);
  }
  EXPECT_GT(energies[0], 0.1);
  for (const double energy : energies) EXPECT_NEAR(energy, energies[0], 1e-3 * energies[0]);
}

// Without a floor what fills the tank has a surface below, too.
TEST(Surface, LiquidHasABottomWhereTheTankIsPeriodicUpwards) {
  Scene scene = water({8, 8, 16}, 0.02);
  scene.tank.periodic[2] = true;
  scene.liquid.fill_level = 0.16;
  Simulation simulation(scene);
  const double volume = 0.16 * 0.16 * 0.16;
  for (int i = 0; i < 5; ++i) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    EXPECT_NEAR(r.liquid_volume, volume, 1e-3 * volume);
    EXPECT_NEAR(r.maximum_speed, 9.81 * r.time, 0.02 * 9.81 * r.time);
  }
}

// What a splash leaves are waves of a few cells, steep ones for the grid. They die away, if slower than real ones.
TEST(Surface, SplashedWaterLosesEnergyAllTheTime) {
  Scene scene = water({20, 16, 16}, 0.02);
  scene.liquid.fill_level = 0.16;
  scene.liquid.boxes = {{Vector3d(0.06, 0.06, 0.2), Vector3d(0.14, 0.14, 0.28)}};
  Simulation simulation(scene);
  const double volume = simulation.report().liquid_volume, level = volume / (0.4 * 0.32);
  const double rest = 0.5 * 1000.0 * 9.81 * level * volume;
  double sums[4] = {};  // of 250 steps each
  for (int step = 0; step < 1000; ++step) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    sums[step / 250] += r.kinetic_energy + r.potential_energy - rest;
  }
  for (int i = 1; i < 4; ++i) EXPECT_LT(sums[i], 0.9 * sums[i - 1]) << "from " << 5 * i << " s on";
}

// A standing wave of 12 cells length, a cell high, without viscosity: half of the height that it may have at all.
TEST(Surface, ASteepWaveGainsNoEnergy) {
  Scene scene = water({20, 16, 16}, 0.02);
  scene.liquid.dynamic_viscosity = 0.0;
  scene.liquid.fill_level = 0.16;
  Simulation simulation(scene);
  const double kx = 2.0 * M_PI / 0.4, ky = 2.0 * M_PI / 0.32, k = std::hypot(kx, ky);
  const double speed = 0.02 * std::sqrt(9.81 * k * std::tanh(0.16 * k)) / std::sinh(0.16 * k);
  simulation.setLiquidVelocity([&](const Vector3d& p) {
    const double along = speed * std::cosh(k * p[2]) / k, cx = std::cos(kx * p[0]), cy = std::cos(ky * p[1]);
    return Vector3d(-kx * along * std::sin(kx * p[0]) * cy, -ky * along * cx * std::sin(ky * p[1]),
                    speed * std::sinh(k * p[2]) * cx * cy);
  });
  const double rest = simulation.report().potential_energy;
  double start = 0.0, end = 0.0;  // sums over 20 steps, a period
  for (int step = 0; step < 300; ++step) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    const double energy = r.kinetic_energy + r.potential_energy - rest;
    if (step < 20) start += energy;
    if (step >= 280) end += energy;
  }
  EXPECT_LT(end, start);
  EXPECT_GT(end, 0.6 * start);
}

// Where the last of the air goes little liquid is driven as fast as what is around it asks for.
TEST(Surface, ACavityThatClosesGainsNoEnergy) {
  constexpr double kWidth = 0.28, kDepth = 0.13, kHalf = 0.05;
  for (const TimeStepping scheme : {TimeStepping::kBdf2, TimeStepping::kBackwardEuler}) {
    for (const auto& [shift, step] : {std::pair(0.0, 0.02), {0.007, 0.02}, {0.01, 0.02}, {0.01, 0.005}}) {
      Scene scene = water({14, 14, 16}, 0.02);
      scene.time_step = step;
      scene.solver.time_stepping = scheme;
      const double c = 0.5 * kWidth + shift;
      scene.liquid.boxes = {{Vector3d(0.0, 0.0, 0.0), Vector3d(c - kHalf, kWidth, kDepth)},
                            {Vector3d(c + kHalf, 0.0, 0.0), Vector3d(kWidth, kWidth, kDepth)},
                            {Vector3d(c - kHalf, 0.0, 0.0), Vector3d(c + kHalf, c - kHalf, kDepth)},
                            {Vector3d(c - kHalf, c + kHalf, 0.0), Vector3d(c + kHalf, kWidth, kDepth)}};
      Simulation simulation(scene);
      const double start = simulation.report().potential_energy;
      const double volume = simulation.report().liquid_volume, level = volume / (kWidth * kWidth);
      const double falls = start - 0.5 * 1000.0 * 9.81 * level * volume;
      double most = 0.0;
      while (simulation.time() < 0.2) {
        const StepReport r = simulation.step();
        ASSERT_TRUE(r.committed()) << r.message;
        // Until then the corners of the boxes become round, which moves the surface.
        if (simulation.time() > 0.05) most = std::max(most, r.kinetic_energy + r.potential_energy - start);
      }
      EXPECT_LT(most, 0.05 * falls) << "shaft " << shift << " m off, step " << step << " s, scheme "
                                    << static_cast<int>(scheme);
    }
  }
}

}  // namespace
}  // namespace monolith
