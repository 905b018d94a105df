#include "simulation/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/scene_file.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

// A cube of 16 cells of 1 cm, its corner at the origin.
Scene tank(double fill_level, double viscosity) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = Eigen::Vector3d::Constant(0.16);
  scene.tank.cell_width = 0.01;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = fill_level;
  scene.time_step = 0.01;
  return scene;
}

TEST(Simulation, AnEmptyTankIsRigidBodyDynamicsAndPaysForNothingElse) {
  Scene scene = tank(0.0, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.12}));
  scene.solver.tolerance = 1e-10;
  Simulation simulation(scene);
  for (int i = 0; i < 10; ++i) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    EXPECT_FALSE(r.model.liquid);
    EXPECT_FALSE(r.model.viscosity);
  }
  EXPECT_NEAR(simulation.bodyStates()[0].velocity[2], -9.81 * 0.1, 1e-9);
  while (simulation.time() < 1.0) ASSERT_TRUE(simulation.step().committed());
  EXPECT_NEAR(simulation.bodyStates()[0].X_WB.translation()[2], 0.02, 5e-4);
  EXPECT_NEAR(simulation.bodyStates()[0].contact.force[2], 9.81 * scene.bodies[0].mass,
              1e-3 * 9.81 * scene.bodies[0].mass);
}

// Liquid that the cells are too wide for is not left out in silence.
TEST(Simulation, RefusesLiquidShallowerThanHalfACell) {
  Scene boxed = tank(0.0, 1.0);
  boxed.liquid.boxes = {Eigen::AlignedBox3d(Eigen::Vector3d(0.02, 0.02, 0.0), Eigen::Vector3d(0.14, 0.14, 0.003))};
  for (const Scene& scene : {tank(0.004, 1.0), boxed}) {
    try {
      Simulation simulation(scene);
      ADD_FAILURE();
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("fill_level"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("cell_width"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(Simulation(tank(0.006, 1.0)).step().liquid_volume, 0.0);
}

TEST(Simulation, AStillTankStaysStillAtAnyLevel) {
  for (const double viscosity : {0.0, 1.0}) {
    for (const double level : {0.05, 0.0537, 0.080004, 0.16}) {
      for (const Discretisation discretisation : {Discretisation::kFitted, Discretisation::kFractions}) {
        Scene scene = tank(level, viscosity);
        scene.solver.discretisation = discretisation;
        Simulation simulation(scene);
        for (int i = 0; i < 20; ++i) {
          const StepReport r = simulation.step();
          ASSERT_TRUE(r.committed()) << r.message;
          EXPECT_LT(r.maximum_speed, 1e-8) << "level " << level << ", viscosity " << viscosity;
          EXPECT_EQ(r.model.free_surface, level < 0.16);
        }
      }
    }
  }
}

TEST(Simulation, BuoyancyIsArchimedes) {
  for (const Discretisation discretisation : {Discretisation::kFitted, Discretisation::kFractions}) {
    Scene scene = tank(0.16, 1.0);
    scene.solver.discretisation = discretisation;
    scene.bodies.push_back(sphereBody("ball", 0.04, 500.0, {0.081, 0.0777, 0.0804}));
    scene.bodies[0].motion = BodyMotion::kFixed;
    Simulation simulation(scene);
    ASSERT_TRUE(simulation.step().committed());
    EXPECT_NEAR(simulation.bodyStates()[0].liquid.force[2] / (9810.0 * volume(scene.bodies[0].shapes[0])), 1.0, 1e-4);
  }
}

// In a full tank gravity does no more than press: a neutral ball that is pushed moves as it does without.
TEST(Simulation, WithoutGravityABodyHasTheSameAddedMass) {
  double speed[2] = {};
  for (const int with : {0, 1}) {
    Scene scene = tank(0.16, 0.001);
    scene.gravity *= with;
    scene.bodies.push_back(sphereBody("ball", 0.03, 1000.0, {0.08, 0.08, 0.08}));
    Simulation simulation(scene);
    Wrench push;
    push.force[0] = 0.05;
    simulation.setWrench(0, push);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulation.step().committed());
    speed[with] = simulation.bodyStates()[0].velocity[0];
  }
  EXPECT_NEAR(speed[0] / speed[1], 1.0, 1e-3);
}

// Wherever the surface and the solids cut their cells.
TEST(Simulation, PotentialEnergyIsThatOfTheLiquidWhereItLies) {
  constexpr double kWeight = 9810.0, kWidth = 0.16, kEdge = 0.08;
  for (const double level : {0.1, 0.1025, 0.107}) {
    for (const double bottom : {0.06, 0.0675}) {
      Scene scene = tank(level, 1.0);
      scene.bodies.push_back(boxBody("box", {kEdge, kEdge, kEdge}, 500.0, {0.08, 0.08, bottom + 0.5 * kEdge}));
      scene.bodies[0].motion = BodyMotion::kFixed;
      const double liquid =
          0.5 * kWeight * (kWidth * kWidth * level * level - kEdge * kEdge * (level * level - bottom * bottom));
      EXPECT_NEAR(Simulation(scene).report().potential_energy, liquid, 1e-4 * liquid) << level << ", " << bottom;
    }
  }
}

TEST(Simulation, ABodyOfTheLiquidsDensityStaysWhereItIsAndDoesNotTurn) {
  for (const double viscosity : {0.001, 1.0}) {
    Scene scene = tank(0.16, viscosity);
    scene.bodies.push_back(sphereBody("ball", 0.02, 1000.0, {0.081, 0.0777, 0.04}));
    scene.bodies.push_back(boxBody("box", {0.05, 0.04, 0.03}, 1000.0, {0.081, 0.0777, 0.1104}));
    scene.bodies[1].X_WB.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
    Simulation simulation(scene);
    for (int i = 0; i < 25; ++i) ASSERT_TRUE(simulation.step().committed());
    for (const BodyState& body : simulation.bodyStates()) {
      EXPECT_LT(body.velocity.norm(), 1e-4) << viscosity;
      EXPECT_LT(body.angular_velocity.norm(), 1e-2) << viscosity;
    }
  }
}

// Faces of cells whose centres lie on a body's surface but for round-off were the only way into the cells behind them.
TEST(Simulation, ABodyMayLieAlongTheCellsButForRoundOff) {
  for (const double offset : {-1e-4, -1e-7, -1e-12, -1e-17, 0.0, 1e-17, 1e-12, 1e-7, 1e-4}) {
    for (const double viscosity : {0.0, 3.0, 300.0}) {
      Scene scene = tank(0.16, viscosity);
      scene.solver.time_stepping = TimeStepping::kBackwardEuler;  // a single solve
      scene.bodies = {sphereBody("ball", 0.02, 4000.0, {0.055, 0.06, 0.045}),
                      boxBody("box", {0.05, 0.04, 0.03}, 600.0, {0.06, 0.065, 0.085 + offset})};
      Simulation simulation(scene);
      const StepReport r = simulation.step();
      EXPECT_TRUE(r.committed()) << "offset " << offset << ", viscosity " << viscosity << ": " << r.message;
      EXPECT_LT(r.iterations, 50);
    }
  }
}

TEST(Simulation, TheDropSceneFallsAndSplashesWithFractions) {
  Scene scene = loadScene(MONOLITH_SOURCE_DIR "/config/scenes/drop.yaml", {});
  scene.solver.discretisation = Discretisation::kFractions;
  scene.tank.cell_width *= 2.0;
  Simulation simulation(scene);
  double volume = 0.0;
  int iterations = 0;  // none while all bodies fall through the air and the liquid is still
  while (simulation.time() < 0.3) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    EXPECT_LE(r.residual, scene.solver.tolerance);
    if (volume == 0.0) volume = r.liquid_volume;
    EXPECT_NEAR(r.liquid_volume, volume, 1e-3 * volume);
    iterations += r.iterations;
  }
  EXPECT_GT(iterations, 0);
  // Steel has sunk, the light ball floats.
  EXPECT_LT(simulation.bodyStates()[0].X_WB.translation()[2], 0.12);
  EXPECT_GT(simulation.bodyStates()[3].X_WB.translation()[2], 0.12);
}

TEST(Simulation, LightAndHeavySpheresStartWithTheirAddedMass) {
  // Cube cavity, a/half-side = 0.5: added-mass coefficient by the method of fundamental solutions, 1e-4.
  constexpr double kAddedMass = 0.62283;
  for (const double ratio : {1e-3, 0.5, 10.0, 1e3}) {
    Scene scene = tank(0.16, 0.0);
    scene.time_step = 1e-3;
    scene.bodies.push_back(sphereBody("ball", 0.04, 1000.0 * ratio, {0.08, 0.08, 0.08}));
    Simulation simulation(scene);
    ASSERT_TRUE(simulation.step().committed());
    const double acceleration = simulation.bodyStates()[0].velocity[2] / scene.time_step;
    const double expected = 9.81 * (1.0 - ratio) / (ratio + kAddedMass);
    EXPECT_NEAR(acceleration / expected, 1.0, 0.05) << "density ratio " << ratio;
  }
}

TEST(Simulation, EnergyNeverGrowsThroughTheSolve) {
  for (const double viscosity : {0.0, 0.5}) {
    for (const double ratio : {1e-3, 1.0, 1e4}) {
      for (const double dt : {1e-4, 1e-2, 1.0}) {
        Scene scene = tank(0.16, viscosity);
        scene.gravity.setZero();
        scene.time_step = dt;
        scene.solver.cfl = 1e9;
        BodyDescription body = boxBody("box", {0.05, 0.04, 0.03}, 1000.0 * ratio, {0.08, 0.075, 0.083});
        body.velocity = Eigen::Vector3d(1e-3, -2e-3, 1.5e-3);
        body.angular_velocity = Eigen::Vector3d(0.02, 0.03, -0.01);
        scene.bodies.push_back(body);
        Simulation simulation(scene);
        // The first step shares the body's start with the liquid that sticks to it; from then on energy only falls;
        // advection between the solves keeps it to within 1e-4.
        double before = simulation.step().kinetic_energy;
        for (int step = 0; step < 3; ++step) {
          const StepReport r = simulation.step();
          ASSERT_TRUE(r.committed()) << r.message;
          EXPECT_LE(r.kinetic_energy, before * (1.0 + 1e-4)) << "ratio " << ratio << ", dt " << dt;
          before = r.kinetic_energy;
        }
      }
    }
  }
}

TEST(Simulation, ActionIsReaction) {
  // No walls, no gravity: what the body loses the liquid gains.
  Scene scene = tank(0.16, 0.0);
  for (bool& periodic : scene.tank.periodic) periodic = true;
  scene.gravity.setZero();
  scene.solver.tolerance = 1e-10;
  scene.solver.time_stepping = TimeStepping::kBackwardEuler;  // one solve, nothing moves before it
  BodyDescription body = sphereBody("ball", 0.03, 700.0, {0.08, 0.08, 0.08});
  body.velocity = Eigen::Vector3d(0.01, 0.02, -0.03);
  scene.bodies.push_back(body);
  Simulation simulation(scene);
  const StepReport r = simulation.step();
  ASSERT_TRUE(r.committed());
  const Eigen::Vector3d total = r.liquid_momentum + body.mass * simulation.bodyStates()[0].velocity;
  EXPECT_LT((total - body.mass * body.velocity).norm(), 1e-8 * body.mass * body.velocity.norm());
}

TEST(Simulation, TheSameBitsAtAnyThreadCount) {
  std::vector<std::vector<BodyState>> states;
  std::vector<std::vector<SurfacePoint>> surfaces;
  for (const int threads : {1, 2, 3}) {
    Scene scene = tank(0.08, 0.7);
    scene.solver.threads = threads;
    scene.bodies.push_back(sphereBody("ball", 0.02, 2500.0, {0.05, 0.06, 0.11}));
    scene.bodies.push_back(boxBody("box", {0.04, 0.03, 0.03}, 400.0, {0.11, 0.1, 0.105}));
    Simulation simulation(scene);
    for (int i = 0; i < 15; ++i) ASSERT_TRUE(simulation.step().committed());
    states.push_back(simulation.bodyStates());
    surfaces.push_back(simulation.surfacePoints());
  }
  for (std::size_t run = 1; run < states.size(); ++run) {
    for (std::size_t b = 0; b < states[0].size(); ++b) {
      EXPECT_EQ(states[run][b].X_WB.matrix(), states[0][b].X_WB.matrix());
      EXPECT_EQ(states[run][b].velocity, states[0][b].velocity);
    }
    ASSERT_EQ(surfaces[run].size(), surfaces[0].size());
    for (std::size_t p = 0; p < surfaces[0].size(); ++p) EXPECT_EQ(surfaces[run][p].position, surfaces[0][p].position);
  }
}

TEST(Simulation, AFailedSolveIsReportedAndNotCommitted) {
  Scene scene = tank(0.1, 1.0);
  scene.solver.maximum_iterations = 1;
  scene.solver.tolerance = 1e-12;
  scene.bodies.push_back(sphereBody("ball", 0.03, 500.0, {0.08, 0.08, 0.06}));
  Simulation simulation(scene);
  const BodyState before = simulation.bodyStates()[0];
  const StepReport r = simulation.step();
  EXPECT_EQ(r.status, SolveStatus::kNotConverged);
  EXPECT_NE(r.message.find("residual"), std::string::npos) << r.message;
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_EQ(simulation.bodyStates()[0].X_WB.matrix(), before.X_WB.matrix());
  EXPECT_EQ(simulation.bodyStates()[0].velocity, before.velocity);
}

// A ball is shot into the liquid: the sub-steps before it arrives take few iterations, one after that too many.
TEST(Simulation, AFailureInALaterSubstepTakesBackThoseBefore) {
  int failures = 0;
  for (int most = 2; most <= 12; ++most) {
    Scene scene = tank(0.08, 1.0);
    scene.time_step = 0.02;
    scene.solver.maximum_iterations = most;
    scene.bodies.push_back(sphereBody("ball", 0.02, 2000.0, {0.08, 0.08, 0.115}));
    Simulation simulation(scene);
    simulation.setBodyState(0, Eigen::Isometry3d(Eigen::Translation3d(0.08, 0.08, 0.115)), {0.0, 0.0, -2.0},
                            Eigen::Vector3d::Zero());
    const Eigen::Vector3d below(0.083, 0.078, 0.05);
    for (int step = 0; step < 3; ++step) {
      const double time = simulation.time();
      const BodyState body = simulation.bodyStates()[0];
      const Eigen::Vector3d velocity = simulation.liquidVelocity(below);
      const std::vector<SurfacePoint> surface = simulation.surfacePoints();
      const StepReport r = simulation.step();
      if (r.committed()) continue;
      if (r.substeps == 1) break;
      ++failures;
      EXPECT_EQ(simulation.time(), time);
      const BodyState after = simulation.bodyStates()[0];
      EXPECT_EQ(after.X_WB.matrix(), body.X_WB.matrix());
      EXPECT_EQ(after.velocity, body.velocity);
      EXPECT_EQ(after.liquid.force, body.liquid.force);
      EXPECT_EQ(simulation.liquidVelocity(below), velocity);
      const std::vector<SurfacePoint> surface_after = simulation.surfacePoints();
      ASSERT_EQ(surface_after.size(), surface.size());
      for (std::size_t i = 0; i < surface.size(); ++i) EXPECT_EQ(surface_after[i].position, surface[i].position);
      break;
    }
  }
  EXPECT_GT(failures, 0);
}

// So few iterations that a thick liquid's sub-steps only converge when they are shorter.
TEST(Simulation, ASubstepThatFailsIsTakenAgainHalfAsLong) {
  Scene scene = tank(0.1, 100.0);
  scene.time_step = 0.02;
  scene.bodies.push_back(sphereBody("ball", 0.03, 3000.0, {0.08, 0.08, 0.06}));
  const auto run = [&](int most, int& retries) {
    scene.solver.maximum_iterations = most;
    Simulation simulation(scene);
    retries = 0;
    for (int step = 1; step <= 4; ++step) {
      const StepReport r = simulation.step();
      if (!r.committed()) return 0.0;
      EXPECT_TRUE(r.message.empty()) << r.message;
      EXPECT_GE(r.substeps, 1 + (r.retries > 0));
      EXPECT_LE(r.residual, scene.solver.tolerance);
      EXPECT_DOUBLE_EQ(simulation.time(), step * scene.time_step);
      retries += r.retries;
    }
    return simulation.bodyStates()[0].velocity[2];
  };
  int retries = 0, helped = 0;
  const double speed = run(200, retries);
  EXPECT_EQ(retries, 0);
  ASSERT_LT(speed, 0.0);
  for (int most = 4; most <= 24; ++most) {
    const double other = run(most, retries);
    if (other == 0.0 || retries == 0) continue;
    ++helped;
    EXPECT_NEAR(other, speed, 0.03 * std::abs(speed)) << most;
  }
  EXPECT_GT(helped, 0);
}

// The state is that of before, and so are its volume and energy in the report.
TEST(Simulation, AFailedStepReportsTheStateThatItLeaves) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 2000.0, {0.08, 0.08, 0.115}));
  Simulation simulation(scene);
  const StepReport good = simulation.step();
  ASSERT_TRUE(good.committed());
  Wrench absurd;
  absurd.force[0] = 1e305;
  simulation.setWrench(0, absurd);
  const StepReport failed = simulation.step();
  ASSERT_FALSE(failed.committed());
  EXPECT_EQ(failed.liquid_volume, good.liquid_volume);
  EXPECT_EQ(failed.potential_energy, good.potential_energy);
  EXPECT_EQ(failed.maximum_speed, good.maximum_speed);
  EXPECT_TRUE(failed.model.liquid);
}

TEST(Simulation, TheReportIsOfTheStateAlsoBeforeTheFirstStepAndAfterASetState) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 2000.0, {0.08, 0.08, 0.04}));
  scene.bodies[0].velocity = Eigen::Vector3d(0.3, 0.0, 0.0);
  const double mass = scene.bodies[0].mass, ball = mass / 2000.0;
  const double volume = 0.16 * 0.16 * 0.08 - ball;
  const auto expectStart = [&](const StepReport& r) {
    EXPECT_NEAR(r.liquid_volume, volume, 0.01 * volume);
    EXPECT_NEAR(r.kinetic_energy, 0.5 * mass * 0.09, 1e-12);
    // The ball's own volume of liquid is missing at its height.
    EXPECT_NEAR(r.potential_energy, 9.81 * 0.04 * (1000.0 * (volume + ball) + mass - 1000.0 * ball), 0.01);
    EXPECT_TRUE(r.model.liquid && r.model.viscosity && r.model.free_surface);
    EXPECT_FALSE(r.model.non_newtonian);
  };
  Simulation simulation(scene);
  EXPECT_EQ(simulation.report().status, SolveStatus::kNotRun);
  expectStart(simulation.report());
  Wrench absurd;
  absurd.force[0] = 1e305;
  simulation.setWrench(0, absurd);
  const StepReport failed = simulation.step();
  ASSERT_FALSE(failed.committed());
  expectStart(failed);

  simulation.setWrench(0, Wrench());
  ASSERT_TRUE(simulation.step().committed());
  simulation.reset();
  EXPECT_EQ(simulation.report().status, SolveStatus::kNotRun);
  expectStart(simulation.report());

  ASSERT_TRUE(simulation.step().committed());
  const BodyState before = simulation.bodyStates()[0];
  const StepReport step = simulation.report();
  Eigen::Isometry3d pose = before.X_WB;
  pose.translation()[2] += 0.01;
  simulation.setBodyState(0, pose, {0.0, 5.0, 0.0}, Eigen::Vector3d::Zero());
  const double gained = 0.5 * mass * (25.0 - before.velocity.squaredNorm());
  EXPECT_NEAR(simulation.report().kinetic_energy - step.kinetic_energy, gained, 0.02 * gained);
  EXPECT_NEAR(simulation.report().potential_energy - step.potential_energy, 9.81 * 0.01 * (mass - 1000.0 * ball), 2e-3);
  EXPECT_EQ(simulation.report().step, 1);
}

TEST(Simulation, LiquidThatIsGivenASpeedIsSteppedAccordingly) {
  Scene scene = tank(0.08, 1.0);
  scene.solver.time_stepping = TimeStepping::kBackwardEuler;
  Simulation simulation(scene);
  const double speed = 4.0 * scene.solver.cfl * scene.tank.cell_width / scene.time_step;
  simulation.setLiquidVelocity([&](const Eigen::Vector3d&) { return Eigen::Vector3d(0.0, 0.0, speed); });
  EXPECT_GE(simulation.step().substeps, 2);
}

// What a body that reaches through a wall by right does, is no reason to refuse another's pose.
TEST(Simulation, ABodysStateIsJudgedByItsOwnOverlapsAlone) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 2000.0, {0.05, 0.05, 0.05}));
  BodyDescription paddle = boxBody("paddle", {0.04, 0.04, 0.04}, 1000.0, {0.13, 0.08, 0.1});
  paddle.motion = BodyMotion::kPrescribed;
  paddle.prescribed.twist[0] = 0.5;
  scene.bodies.push_back(paddle);
  Simulation simulation(scene);
  for (int i = 0; i < 40 && simulation.bodyStates()[1].X_WB.translation()[0] < 0.15; ++i) {
    ASSERT_TRUE(simulation.step().committed());
  }
  ASSERT_GT(simulation.bodyStates()[1].X_WB.translation()[0], 0.145);
  const Eigen::Isometry3d free(Eigen::Translation3d(0.05, 0.06, 0.05)), inside(Eigen::Translation3d(0.13, 0.08, 0.1));
  simulation.setBodyState(0, free, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  EXPECT_EQ(simulation.bodyStates()[0].X_WB.translation(), free.translation());
  EXPECT_THROW(simulation.setBodyState(0, inside, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()),
               std::invalid_argument);
}

TEST(Simulation, APistonOnSealedLiquidIsRefusedByName) {
  Scene scene = tank(0.16, 1.0);
  BodyDescription piston = boxBody("piston", {0.16, 0.16, 0.03}, 1000.0, {0.08, 0.08, 0.08});
  piston.motion = BodyMotion::kPrescribed;
  piston.prescribed.twist[2] = 0.1;
  scene.bodies.push_back(piston);
  Simulation simulation(scene);
  const StepReport r = simulation.step();
  EXPECT_EQ(r.status, SolveStatus::kInconsistent);
  EXPECT_NE(r.message.find("piston"), std::string::npos) << r.message;
}

TEST(Simulation, AHeavyBoxOnALightOneUnderLiquidStaysPut) {
  Scene scene = tank(0.14, 1.0);
  scene.bodies.push_back(boxBody("light", {0.06, 0.06, 0.03}, 1200.0, {0.08, 0.08, 0.0151}));
  scene.bodies.push_back(boxBody("heavy", {0.06, 0.06, 0.03}, 8000.0, {0.08, 0.08, 0.0452}));
  Simulation simulation(scene);
  double deepest = 0.0;
  while (simulation.time() < 1.0) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    deepest = std::max(deepest, r.penetration);
  }
  EXPECT_LT(deepest, 0.05 * scene.tank.cell_width);
  for (const BodyState& s : simulation.bodyStates()) EXPECT_LT(s.velocity.norm(), 1e-4);
  EXPECT_NEAR(simulation.bodyStates()[1].X_WB.translation()[2], 0.045, 1e-4);
}

TEST(Simulation, AFloatingBodySinksAsDeepAsItIsHeavy) {
  Scene scene = tank(0.08, 2.0);
  scene.bodies.push_back(boxBody("float", {0.08, 0.08, 0.04}, 500.0, {0.08, 0.08, 0.105}));
  Simulation simulation(scene);
  const double start = simulation.step().liquid_volume;
  while (simulation.time() < 3.0) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    EXPECT_NEAR(r.liquid_volume / start, 1.0, 1e-3);
  }
  const double level = 0.08 + 0.02 * 0.0064 / 0.0256;
  const double draught = level - (simulation.bodyStates()[0].X_WB.translation()[2] - 0.02);
  EXPECT_NEAR(draught, 0.02, 0.25 * scene.tank.cell_width);
}

TEST(Simulation, BadInputIsRefusedAndLosesNothing) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.12}));
  scene.bodies.push_back(sphereBody("other", 0.02, 500.0, {0.04, 0.04, 0.12}));
  Simulation simulation(scene);
  Wrench bad;
  bad.force[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(simulation.setWrench(0, bad), std::invalid_argument);
  EXPECT_THROW(simulation.setWrench(7, Wrench()), std::invalid_argument);
  Eigen::Isometry3d outside = Eigen::Isometry3d::Identity();
  EXPECT_THROW(simulation.setBodyState(0, outside, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()),
               std::invalid_argument);
  outside.translation() = Eigen::Vector3d(0.045, 0.04, 0.12);  // inside the other
  EXPECT_THROW(simulation.setBodyState(0, outside, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()),
               std::invalid_argument);
  EXPECT_EQ(simulation.bodyStates()[0].X_WB.translation(), Eigen::Vector3d(0.08, 0.08, 0.12));
  EXPECT_TRUE(simulation.step().committed());

  scene.bodies[1].X_WB.translation() = Eigen::Vector3d(0.09, 0.08, 0.12);
  try {
    Simulation overlapping(scene);
    FAIL() << "overlap accepted";
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("ball"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("other"), std::string::npos);
  }
}

// What is small beside absurd speeds is a long way all the same: no committed step may leave the ball outside.
TEST(Simulation, ABodyThatIsPushedThroughAWallFailsTheStepAndStays) {
  int failures = 0;
  for (const double level : {0.0, 0.08}) {
    for (const double force : {1e6, 1e9, 1e12, 1e14}) {
      Scene scene = tank(level, 1.0);
      scene.tank.cell_width = 0.02;
      scene.solver.threads = 1;
      scene.bodies.push_back(sphereBody("ball", 0.02, 900.0, {0.06, 0.08, 0.05}));
      Simulation simulation(scene);
      Wrench push;
      push.force = force * Eigen::Vector3d(1.0, 0.3, 0.1);
      simulation.setWrench(0, push);
      for (int i = 0; i < 3; ++i) {
        const BodyState before = simulation.bodyStates()[0];
        const double time = simulation.time();
        const StepReport r = simulation.step();
        const BodyState after = simulation.bodyStates()[0];
        const Eigen::Vector3d from_centre = after.X_WB.translation() - Eigen::Vector3d::Constant(0.08);
        EXPECT_LE(from_centre.cwiseAbs().maxCoeff(), 0.06 + 0.5 * scene.tank.cell_width) << level << ", " << force;
        if (r.committed()) continue;
        EXPECT_EQ(simulation.time(), time);
        EXPECT_EQ(after.X_WB.matrix(), before.X_WB.matrix());
        EXPECT_EQ(after.velocity, before.velocity);
        if (r.message.find("body 'ball' would stick out of the tank's wall +") == std::string::npos) break;
        EXPECT_NE(r.message.find("expected at most half a cell, 0.01 m"), std::string::npos) << r.message;
        ++failures;
        // It goes on once the push is over.
        simulation.setWrench(0, Wrench());
        EXPECT_TRUE(simulation.step().committed());
        break;
      }
    }
  }
  EXPECT_GE(failures, 3);
}

TEST(Simulation, ABodyThatIsPushedIntoAnotherFailsTheStepAndStays) {
  Scene scene = tank(0.0, 1.0);
  for (bool& periodic : scene.tank.periodic) periodic = true;
  scene.gravity.setZero();
  scene.bodies.push_back(sphereBody("ball", 0.02, 900.0, {0.04, 0.08, 0.05}));
  scene.bodies.push_back(boxBody("post", {0.03, 0.03, 0.03}, 900.0, {0.12, 0.08, 0.05}));
  scene.bodies[1].motion = BodyMotion::kFixed;
  Simulation simulation(scene);
  int failures = 0;
  for (double force = 1e8; force < 2e12; force *= 1e2) {
    simulation.reset();
    Wrench push;
    push.force[0] = force;
    simulation.setWrench(0, push);
    const StepReport r = simulation.step();
    if (r.committed()) {
      EXPECT_LE(simulation.bodyStates()[0].X_WB.translation()[0], 0.09);
      continue;
    }
    EXPECT_EQ(simulation.bodyStates()[0].X_WB.translation(), Eigen::Vector3d(0.04, 0.08, 0.05));
    if (r.message.find("bodies 'ball' and 'post' would overlap by") != std::string::npos) ++failures;
  }
  EXPECT_GE(failures, 1);
}

// Nothing stops a paddle, but what it leaves no room does not leave the tank for it.
TEST(Simulation, APaddleMayPressABodyAgainstAWall) {
  Scene scene = tank(0.0, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 900.0, {0.12, 0.08, 0.02}));
  BodyDescription paddle = boxBody("paddle", {0.03, 0.1, 0.1}, 900.0, {0.07, 0.08, 0.06});
  paddle.motion = BodyMotion::kPrescribed;
  paddle.prescribed.twist[0] = 0.1;
  scene.bodies.push_back(paddle);
  Simulation simulation(scene);
  while (simulation.bodyStates()[1].X_WB.translation()[0] < 0.13) {
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
  }
  EXPECT_NEAR(simulation.bodyStates()[0].X_WB.translation()[0], 0.14, 0.05 * scene.tank.cell_width);
}

// The liquid's volume alone does not tell why it grows.
TEST(Simulation, WhatIsPrescribedToLeaveTheTankIsToldOnce) {
  Scene scene = tank(0.16, 1.0);
  scene.bodies.push_back(boxBody("pad", {0.04, 0.04, 0.04}, 900.0, {0.13, 0.08, 0.08}));
  scene.bodies[0].motion = BodyMotion::kPrescribed;
  scene.bodies[0].prescribed.twist[0] = 0.2;
  Simulation simulation(scene);
  for (int round = 0; round < 2; ++round, simulation.reset()) {
    std::vector<std::string> told;
    while (simulation.bodyStates()[0].X_WB.translation()[0] < 0.19) {
      const StepReport r = simulation.step();
      ASSERT_TRUE(r.committed()) << r.message;
      if (r.warning.empty()) continue;
      told.push_back(r.warning);
      EXPECT_LT(simulation.bodyStates()[0].X_WB.translation()[0], 0.15) << "as soon as it is more than half a cell";
    }
    ASSERT_EQ(told.size(), 1U);
    EXPECT_NE(told[0].find("body 'pad' moves out of the tank through its wall +x"), std::string::npos) << told[0];
  }
}

// Each number is finite, the velocity of the centre of mass beside the body's origin is not.
TEST(Simulation, ASpinTooLargeForANumberAtTheCentreOfMassIsRefused) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.05}));
  scene.bodies[0].p_BBcm = Eigen::Vector3d(0.0, 0.01, 0.0);
  Simulation simulation(scene);
  const BodyState before = simulation.bodyStates()[0];
  try {
    simulation.setBodyState(0, before.X_WB, {-1.79e308, 0.0, 0.0}, {0.0, 0.0, 1.7e308});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    for (const char* part : {"'ball'", "velocity [-inf, ", "expected finite"}) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << part << " in: " << error.what();
    }
  }
  EXPECT_EQ(simulation.bodyStates()[0].velocity, before.velocity);
  EXPECT_TRUE(simulation.step().committed());
}

TEST(Simulation, AnAbsurdSpeedEndsInAReport) {
  Scene scene = tank(0.08, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.05}));
  Simulation simulation(scene);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.08, 0.08, 0.05);
  simulation.setBodyState(0, pose, Eigen::Vector3d(1e9, 0.0, 0.0), Eigen::Vector3d(1e9, 0.0, 0.0));
  const StepReport r = simulation.step();
  EXPECT_TRUE(simulation.bodyStates()[0].X_WB.matrix().allFinite());
  EXPECT_TRUE(r.committed() || !r.message.empty());
}

TEST(Simulation, AWrenchPushesAndResetForgetsIt) {
  Scene scene = tank(0.08, 1.0);
  scene.gravity.setZero();
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.04}));
  Simulation simulation(scene);
  Wrench push;
  push.force[0] = 0.05;
  simulation.setWrench(0, push);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
  EXPECT_GT(simulation.bodyStates()[0].velocity[0], 1e-3);
  simulation.reset();
  EXPECT_EQ(simulation.time(), 0.0);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().committed());
  EXPECT_LT(simulation.bodyStates()[0].velocity.norm(), 1e-9);
}

// Boxes that are pushed about at their limit of friction: the solver learns from steps how to make the next, and must
// not know anything of them after a reset.
TEST(Simulation, ARunAfterAResetIsTheSameToTheBit) {
  Scene scene = tank(0.08, 2.0);
  scene.contact.friction = 0.3;
  scene.bodies = {boxBody("low", {0.05, 0.04, 0.02}, 2000.0, {0.07, 0.08, 0.01}),
                  boxBody("high", {0.03, 0.03, 0.02}, 2000.0, {0.07, 0.08, 0.03})};
  Simulation simulation(scene);
  std::vector<Eigen::Vector3d> velocities[2];
  int solves[2] = {};
  for (int run = 0; run < 2; ++run) {
    // Ends where contacts take more than one solve.
    for (int step = 0; step < 20; ++step) {
      for (int body = 0; body < 2; ++body) {
        const double angle = 1.9 * step + body;
        Wrench push;
        push.force = 0.3 * scene.bodies[body].mass * 9.81 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
        simulation.setWrench(body, push);
      }
      const StepReport report = simulation.step();
      ASSERT_TRUE(report.committed()) << report.message;
      solves[run] += report.liquid_solves - report.substeps;
      for (const BodyState& state : simulation.bodyStates()) velocities[run].push_back(state.velocity);
    }
    simulation.reset();
  }
  EXPECT_GT(solves[0], 0);
  EXPECT_EQ(solves[0], solves[1]);
  for (std::size_t i = 0; i < velocities[0].size(); ++i) EXPECT_EQ(velocities[0][i], velocities[1][i]) << i;
}

// After steps of second order geometry is where bodies were to be, not where they are.
TEST(Simulation, AStepThatFailsLeavesNoTrace) {
  Scene scene = tank(0.08, 0.5);
  scene.bodies.push_back(sphereBody("ball", 0.025, 400.0, {0.08, 0.08, 0.09}));
  scene.solver.tolerance = 1e-8;
  Simulation disturbed(scene), undisturbed(scene);
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(disturbed.step().committed());
    ASSERT_TRUE(undisturbed.step().committed());
  }
  const std::vector<SurfacePoint> surface = disturbed.surfacePoints();
  Wrench absurd;
  absurd.force[0] = 1e305;
  disturbed.setWrench(0, absurd);
  for (int i = 0; i < 2; ++i) ASSERT_FALSE(disturbed.step().committed());
  disturbed.setWrench(0, Wrench());
  const std::vector<SurfacePoint> after = disturbed.surfacePoints();
  ASSERT_EQ(after.size(), surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) EXPECT_EQ(after[i].position, surface[i].position);
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(disturbed.step().committed());
    ASSERT_TRUE(undisturbed.step().committed());
  }
  const Eigen::Vector3d x = disturbed.bodyStates()[0].X_WB.translation();
  EXPECT_LT((x - undisturbed.bodyStates()[0].X_WB.translation()).norm(), 1e-8);
}

// What is too fast for any number of sub-steps gets so many and no more.
TEST(Simulation, AStepHasABoundedNumberOfSubsteps) {
  Scene scene = tank(0.0, 1.0);
  scene.bodies.push_back(sphereBody("ball", 0.02, 500.0, {0.08, 0.08, 0.08}));
  scene.bodies[0].angular_velocity[2] = 1e6;
  Simulation simulation(scene);
  for (int i = 0; i < 3; ++i) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
    EXPECT_GE(report.substeps, 64);
    EXPECT_LE(report.substeps, 66);  // and two of the first step
  }
}

// Liquid that sticks to a body is not set with it: of the momentum that the body has, all is shared, none is added.
TEST(Simulation, ABodyThatIsSetMovingInLiquidAtRestAddsNoMomentum) {
  for (const double viscosity : {0.0, 0.1, 100.0}) {
    Scene scene = tank(0.16, viscosity);
    for (bool& periodic : scene.tank.periodic) periodic = true;
    scene.gravity.setZero();
    scene.time_step = 0.02;
    scene.bodies.push_back(sphereBody("ball", 0.035, 300.0, {0.08, 0.08, 0.08}));
    scene.bodies[0].velocity[0] = 0.5;
    const double momentum = 0.5 * scene.bodies[0].mass;
    Simulation simulation(scene);
    const StepReport r = simulation.step();
    ASSERT_TRUE(r.committed()) << r.message;
    const double after = r.liquid_momentum[0] + scene.bodies[0].mass * simulation.bodyStates()[0].velocity[0];
    EXPECT_NEAR(after, momentum, 0.02 * momentum) << viscosity;
  }
}

TEST(Simulation, LiquidThatIsGivenASpeedHasItUpToTheWalls) {
  Simulation simulation(tank(0.16, 0.0));
  simulation.setLiquidVelocity([](const Eigen::Vector3d&) { return Eigen::Vector3d(0.0, 0.3, 0.0); });
  EXPECT_NEAR(simulation.liquidVelocity({0.001, 0.08, 0.08})[1], 0.3, 1e-12);
  EXPECT_NEAR(simulation.liquidVelocity({0.08, 0.08, 0.159})[1], 0.3, 1e-12);
  EXPECT_THROW((void)simulation.liquidVelocity({NAN, 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace monolith
