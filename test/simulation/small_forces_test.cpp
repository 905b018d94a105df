// Forces far below the solve's tolerance: the residual is relative to all that acts, gravity on all of the liquid and
// the momentum of the heaviest body included, and still they move what they act on.

#include <gtest/gtest.h>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

void pushAndRun(Simulation& simulation, int body, const Vector3d& acceleration, double end) {
  simulation.setWrench(body, {simulation.bodies()[body].mass * acceleration, Vector3d::Zero()});
  while (simulation.time() < end - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_TRUE(report.committed()) << report.message;
  }
}

TEST(SmallForces, MoveABodyInStillLiquidInProportion) {
  for (const double viscosity : {0.001, 1.0}) {
    double per_push = 0.0;
    for (const double push : {1e-2, 1e-4, 1e-6}) {
      Scene scene;
      scene.source = "test";
      scene.tank.size = {0.64, 0.4, 0.4};
      scene.tank.cell_width = 0.02;
      scene.liquid.density = 1000.0;
      scene.liquid.dynamic_viscosity = viscosity;
      scene.liquid.fill_level = 0.3;
      scene.time_step = 0.02;
      scene.bodies = {sphereBody("ball", 0.04, 1000.0, {0.3, 0.2, 0.15})};
      Simulation simulation(scene);
      pushAndRun(simulation, 0, push * Vector3d::UnitX(), 0.5);
      const double speed = simulation.bodyStates()[0].velocity[0];
      if (per_push == 0.0) per_push = speed / push;
      EXPECT_GT(per_push, 0.01);
      EXPECT_NEAR(speed / push / per_push, 1.0, 0.02) << push << ", viscosity " << viscosity;
      // What is reported of the last step is what moved the body.
      const double liquid = simulation.bodyStates()[0].liquid.force[0];
      EXPECT_LT(liquid, 0.0);
      EXPECT_GT(liquid, -simulation.bodies()[0].mass * push);
    }
  }
}

TEST(SmallForces, MoveWhatNothingTouchesExactly) {
  for (const bool wet_tank : {false, true}) {
    Scene scene;
    scene.source = "test";
    scene.tank.size = {2.0, 0.4, 0.6};
    scene.tank.cell_width = 0.04;
    scene.liquid.density = 1000.0;
    scene.liquid.dynamic_viscosity = 0.1;
    scene.liquid.fill_level = wet_tank ? 0.12 : 0.0;
    scene.gravity.setZero();
    scene.time_step = 0.02;
    scene.bodies = {sphereBody("light", 0.05, 1000.0, {0.1, 0.2, 0.5}),
                    sphereBody("heavy", 0.05, 1e7, {1.7, 0.2, 0.5})};
    scene.bodies[0].velocity = {0.2, 0.0, 0.0};
    scene.bodies[1].velocity = {-0.5, 0.0, 0.0};
    Simulation simulation(scene);
    pushAndRun(simulation, 0, {1e-5, 0.0, 0.0}, 0.5);
    EXPECT_NEAR(simulation.bodyStates()[0].velocity[0] - 0.2, 5e-6, 1e-12) << wet_tank;
  }
}

}  // namespace
}  // namespace monolith
