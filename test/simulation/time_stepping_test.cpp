#include "simulation/time_stepping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

Scene cube(int cells, double viscosity, double fill_level) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = Eigen::Vector3d::Constant(0.16);
  scene.tank.cell_width = 0.16 / cells;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = fill_level;
  return scene;
}

// A ball that starts to swing smoothly. So viscous that every time step resolves the film on the ball.
Scene swingingBall() {
  Scene scene = cube(12, 20.0, 0.16);
  scene.bodies = {sphereBody("ball", 0.03, 2000.0, {0.08, 0.08, 0.08})};
  scene.bodies[0].motion = BodyMotion::kPrescribed;
  scene.bodies[0].prescribed.amplitude[0] = 0.01;
  scene.bodies[0].prescribed.frequency = 2.0;
  scene.bodies[0].prescribed.phase = -0.5 * M_PI;
  return scene;
}

Scene sinkingBall() {
  Scene scene = cube(16, 5.0, 0.16);
  scene.bodies = {sphereBody("ball", 0.03, 2000.0, {0.08, 0.08, 0.09})};
  return scene;
}

// A sheet of liquid, half a cosine along x, 8.5 cells deep.
Scene standingWave(double viscosity) {
  constexpr int kCells = 16;
  Scene scene = cube(kCells, viscosity, 0.0);
  const double h = scene.tank.cell_width;
  scene.tank.size[1] = 4 * h;
  scene.tank.origin.setZero();
  scene.tank.periodic[1] = true;
  for (int i = 0; i < kCells; ++i) {
    const double top = 0.08 + 0.5 * h + 0.002 * std::cos(M_PI * (i + 0.5) / kCells);
    scene.liquid.boxes.emplace_back(Eigen::Vector3d::Zero(), Eigen::Vector3d((i + 1) * h, 4 * h, top));
  }
  return scene;
}

double waveHeight(const Simulation& simulation) {
  double n = 0.0, f = 0.0, ff = 0.0, z = 0.0, fz = 0.0;
  for (const SurfacePoint& p : simulation.surfacePoints()) {
    const double shape = std::cos(M_PI * p.position[0] / 0.16);
    n += 1.0;
    f += shape;
    ff += shape * shape;
    z += p.position[2];
    fz += shape * p.position[2];
  }
  return (fz * n - f * z) / (ff * n - f * f);
}

using Measure = std::function<std::vector<double>(const Simulation&)>;

std::vector<double> liquidVelocities(const Simulation& simulation) {
  const TankDescription& tank = simulation.scene().tank;
  std::vector<double> out;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 5; ++j) {
      for (int k = 0; k < 7; ++k) {
        const Eigen::Vector3d part((i + 0.5) / 9.0, (j + 0.5) / 5.0, 0.45 * (k + 0.5) / 7.0);
        const Eigen::Vector3d u = simulation.liquidVelocity(tank.origin + tank.size.cwiseProduct(part));
        out.insert(out.end(), u.data(), u.data() + 3);
      }
    }
  }
  return out;
}

std::vector<double> bodyVelocity(const Simulation& simulation) {
  const Eigen::Vector3d v = simulation.bodyStates()[0].velocity;
  return {v[0], v[1], v[2]};
}

std::vector<double> surface(const Simulation& simulation) { return {waveHeight(simulation)}; }

std::vector<double> runUntil(Scene scene, TimeStepping scheme, double dt, double end, const Measure& measure) {
  scene.solver.time_stepping = scheme;
  scene.solver.tolerance = 1e-9;
  scene.solver.cfl = 4.0;
  scene.time_step = dt;
  Simulation simulation(scene);
  for (long i = 0; i < std::lround(end / dt); ++i) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
  }
  return measure(simulation);
}

struct Errors {
  double coarse = 0.0, fine = 0.0;  // at dt and dt/4, relative
  double order() const { return 0.5 * std::log2(coarse / fine); }
};

// Against a run with a far smaller step on the same grid.
Errors errors(const Scene& scene, TimeStepping scheme, double dt, double end, const Measure& measure,
              const std::vector<double>& reference) {
  const auto error = [&](double step) {
    const std::vector<double> result = runUntil(scene, scheme, step, end, measure);
    double difference = 0.0, size = 0.0;
    for (std::size_t i = 0; i < result.size(); ++i) {
      difference += std::pow(result[i] - reference[i], 2);
      size += std::pow(reference[i], 2);
    }
    return std::sqrt(difference / size);
  };
  return {error(dt), error(0.25 * dt)};
}

void expectOrders(const Scene& scene, double dt, double end, const Measure& measure) {
  const std::vector<double> reference = runUntil(scene, TimeStepping::kBdf2, dt / 16.0, end, measure);
  const Errors first = errors(scene, TimeStepping::kBackwardEuler, dt, end, measure, reference);
  const Errors second = errors(scene, TimeStepping::kBdf2, dt, end, measure, reference);
  EXPECT_NEAR(first.order(), 1.0, 0.2) << first.coarse << " " << first.fine;
  EXPECT_GT(second.order(), 1.8) << second.coarse << " " << second.fine;
  // At the same cost.
  EXPECT_LT(second.fine, 0.2 * first.fine);
}

TEST(TimeStepping, LiquidVelocityIsOfSecondOrder) {
  const Scene scene = swingingBall();
  expectOrders(scene, 0.01, 0.16, liquidVelocities);
  // Longer steps are more accurate than the order tells.
  const std::vector<double> reference = runUntil(scene, TimeStepping::kBdf2, 0.02 / 16.0, 0.16, liquidVelocities);
  EXPECT_LT(errors(scene, TimeStepping::kBdf2, 0.02, 0.16, liquidVelocities, reference).coarse, 8e-4);
}

TEST(TimeStepping, BodyVelocityIsOfSecondOrder) { expectOrders(sinkingBall(), 0.04, 0.16, bodyVelocity); }

// As fast as its time step or faster: it stays about its place, and is resolved as far as sub-steps go.
TEST(TimeStepping, WhatVibratesStaysAboutItsPlace) {
  constexpr double kAmplitude = 1e-3, kPhase = 0.3, kStep = 0.02;
  for (const TimeStepping scheme : {TimeStepping::kBackwardEuler, TimeStepping::kBdf2}) {
    for (const double frequency : {5.0, 50.0, 73.0, 1000.0}) {
      Scene scene = cube(8, 0.1, 0.08);
      scene.solver.time_stepping = scheme;
      scene.time_step = kStep;
      scene.bodies = {boxBody("plate", Eigen::Vector3d::Constant(0.06), 1000.0, Eigen::Vector3d::Constant(0.08))};
      scene.bodies[0].motion = BodyMotion::kPrescribed;
      PrescribedMotion& motion = scene.bodies[0].prescribed;
      motion.amplitude << kAmplitude, 0.0, 0.0, 0.0, 10.0 * kAmplitude, 0.0;
      motion.frequency = frequency;
      motion.phase = kPhase;
      Simulation simulation(scene);
      for (int i = 0; i < 3; ++i) {
        const StepReport report = simulation.step();
        ASSERT_TRUE(report.committed()) << report.message;
        EXPECT_GE(report.substeps, std::min(64.0, 10.0 * frequency * kStep)) << frequency;
        const Eigen::Isometry3d X_WB = simulation.bodyStates()[0].X_WB;
        const double moved =
            kAmplitude * (std::sin(2.0 * M_PI * frequency * simulation.time() + kPhase) - std::sin(kPhase));
        EXPECT_NEAR(X_WB.translation()[0], 0.08 + moved, 1e-9) << frequency;
        EXPECT_NEAR(std::asin(X_WB.linear()(0, 2)), 10.0 * moved, 1e-8) << frequency;
      }
      ASSERT_EQ(simulation.warnings().size(), frequency > 320.0 ? 1U : 0U) << frequency;
      if (frequency > 320.0) {
        EXPECT_NE(simulation.warnings()[0].find("test: body 'plate': prescribed.frequency: value 1000 Hz"),
                  std::string::npos)
            << simulation.warnings()[0];
      }
    }
  }
}

TEST(TimeStepping, SurfaceIsOfSecondOrder) { expectOrders(standingWave(5.0), 0.01, 0.16, surface); }

TEST(TimeStepping, WeightsAreExactForAConstantAccelerationAtAnyRatio) {
  for (const double last : {0.5, 1.0, 3.0}) {
    const StepWeights w = bdf2Weights(1.0, last);
    EXPECT_EQ(w.order, 2);
    EXPECT_NEAR(w.implicit + w.carry, 1.0, 1e-15);
    // u = t^2 with u^n at 0: mean acceleration before -last, acceleration at the end 2.
    EXPECT_NEAR(w.carry * -last + w.implicit * 2.0, 1.0, 1e-14);
  }
  EXPECT_EQ(bdf2Weights(1.0, 0.4).order, 1);
  EXPECT_EQ(bdf2Weights(1.0, 0.0).order, 1);
}

TEST(TimeStepping, ReportedWrenchesAreWhatMovesTheBody) {
  for (const TimeStepping scheme : {TimeStepping::kBackwardEuler, TimeStepping::kBdf2}) {
    // Falls into the liquid and on to the floor.
    Scene scene = cube(16, 0.5, 0.06);
    scene.solver.time_stepping = scheme;
    scene.bodies = {sphereBody("ball", 0.02, 3000.0, {0.08, 0.08, 0.09})};
    Simulation simulation(scene);
    const double mass = scene.bodies[0].mass;
    Wrench push;
    push.force = Eigen::Vector3d(0.1, 0.0, 0.0);
    simulation.setWrench(0, push);
    bool second_order = false, touched = false;
    for (int i = 0; i < 25; ++i) {
      const Eigen::Vector3d before = simulation.bodyStates()[0].velocity;
      const StepReport r = simulation.step();
      ASSERT_TRUE(r.committed()) << r.message;
      const BodyState s = simulation.bodyStates()[0];
      const Eigen::Vector3d change = mass * (s.velocity - before) / scene.time_step;
      const Eigen::Vector3d sum = s.liquid.force + s.contact.force + push.force + mass * scene.gravity;
      EXPECT_LT((change - sum).norm(), 1e-3 * mass * 9.81) << r.time;
      second_order = second_order || r.model.time_order == 2;
      touched = touched || s.contact.force[2] > 0.0;
    }
    EXPECT_EQ(second_order, scheme == TimeStepping::kBdf2);
    EXPECT_TRUE(touched);
  }
}

TEST(TimeStepping, AnImpactLeavesNoSpeedBehind) {
  for (const double level : {0.0, 0.08}) {
    Scene scene = cube(16, 0.01, level);
    scene.time_step = 0.01;
    scene.bodies = {boxBody("box", {0.04, 0.04, 0.04}, 8000.0, {0.08, 0.08, 0.11})};
    Simulation simulation(scene);
    double deepest = 0.0, up = 0.0;
    while (simulation.time() < 0.5) {
      const StepReport r = simulation.step();
      ASSERT_TRUE(r.committed()) << r.message;
      deepest = std::max(deepest, r.penetration);
      up = std::max(up, simulation.bodyStates()[0].velocity[2]);
    }
    EXPECT_LT(up, 0.01) << level;
    EXPECT_LT(deepest, 0.05 * scene.tank.cell_width) << level;
    EXPECT_NEAR(simulation.bodyStates()[0].X_WB.translation()[2], 0.02, 1e-4) << level;
  }
}

TEST(TimeStepping, AStateThatIsSetHasNoPast) {
  Scene scene = cube(8, 1.0, 0.16);
  scene.bodies = {sphereBody("ball", 0.03, 1000.0, {0.08, 0.08, 0.08})};
  Simulation simulation(scene);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulation.step().committed());
  EXPECT_EQ(simulation.report().model.time_order, 2);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.07, 0.08, 0.08);
  simulation.setBodyState(0, pose, Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d::Zero());
  for (const int order : {1, 1, 2}) {
    ASSERT_TRUE(simulation.step().committed());
    EXPECT_EQ(simulation.report().model.time_order, order);
  }
}

TEST(TimeStepping, AFloatingBoxAtRestStaysThere) {
  Scene scene = cube(16, 0.0, 0.08);
  scene.bodies = {boxBody("box", {0.06, 0.06, 0.04}, 500.0, {0.08, 0.08, 0.08})};
  Simulation simulation(scene);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulation.step().committed());
  EXPECT_LT(simulation.bodyStates()[0].velocity.norm(), 1e-7);
}

// In steps that are longer than any number of sub-steps may be, the surface's shortest waves grow until all the liquid
// is gone. Thick liquid damps them.
TEST(TimeStepping, AStepTooLongForTheSurfaceIsRefused) {
  const auto refusal = [](double viscosity, double fill_level, double time_step) -> std::string {
    Scene scene = cube(8, viscosity, fill_level);
    scene.time_step = time_step;
    try {
      Simulation simulation(scene);
      for (int i = 0; i < 3; ++i) {
        const StepReport report = simulation.step();
        EXPECT_TRUE(report.committed()) << report.message;
        EXPECT_NEAR(report.liquid_volume, 0.16 * 0.16 * fill_level, 0.01 * 0.16 * 0.16 * fill_level);
      }
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(0.001, 0.08, 3.3).find("test: time_step: value 3.3 s: expected at most 2.97"), std::string::npos)
      << refusal(0.001, 0.08, 3.3);
  EXPECT_NE(refusal(0.001, 0.08, 3.3).find("tank.cell_width 0.02 m"), std::string::npos);
  EXPECT_EQ(refusal(0.001, 0.08, 2.9), "");
  EXPECT_EQ(refusal(1.0, 0.08, 5.0), "");
  EXPECT_EQ(refusal(0.001, 0.16, 5.0), "") << "no surface, no waves";
}

TEST(TimeStepping, AnInviscidWaveNeitherGrowsNorDies) {
  Scene scene = standingWave(0.0);
  scene.time_step = 0.02;
  Simulation simulation(scene);
  // Period 2 pi/sqrt(g k tanh(k d)) = 0.47 s.
  double early = 0.0, late = 0.0;
  while (simulation.time() < 5.0) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    double& largest = r.time < 0.6 ? early : late;
    if (r.time < 0.6 || r.time > 4.0) largest = std::max(largest, std::abs(r.liquid_momentum[0]));
  }
  EXPECT_NEAR(late / early, 1.0, 0.05);
}

}  // namespace
}  // namespace monolith
