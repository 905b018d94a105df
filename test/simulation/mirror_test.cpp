// A scene and its mirror image go on as mirror images: the grid's low and high sides are alike.

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/simulation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

// Of liquid that turns beside the middle of a closed box, which vorticity off its centre carries along the walls.
double energyLeft(bool mirrored, double end) {
  constexpr double kWidth = 0.4;
  Scene scene;
  scene.source = "test";
  scene.tank.size = {kWidth, kWidth, 0.08};
  scene.tank.cell_width = 0.02;
  scene.liquid.density = 1000.0;
  scene.liquid.fill_level = 0.08;
  scene.time_step = 0.02;
  scene.solver.tolerance = 1e-9;
  Simulation simulation(scene);
  simulation.setLiquidVelocity([&](const Vector3d& at) -> Vector3d {
    // Curl of a stream function sin^2 sin sin: more at low x and y.
    const double x = M_PI * (mirrored ? kWidth - at[0] : at[0]) / kWidth;
    const double y = M_PI * (mirrored ? kWidth - at[1] : at[1]) / kWidth;
    const double u = std::sin(x) * std::cos(y) + 0.6 * std::sin(2.0 * x) * std::cos(y);
    const double v = -std::cos(x) * std::sin(y) - 1.2 * std::cos(2.0 * x) * std::sin(y);
    return {mirrored ? -u : u, mirrored ? -v : v, 0.0};
  });
  double first = 0.0;
  StepReport report;
  while (simulation.time() < end) {
    report = simulation.step();
    EXPECT_TRUE(report.committed()) << report.message;
    if (first == 0.0) first = report.kinetic_energy;
  }
  return report.kinetic_energy / first;
}

TEST(Mirror, AnEddyLosesAsMuchAsItsImage) {
  const double left = energyLeft(false, 1.0), image = energyLeft(true, 1.0);
  EXPECT_LT(left, 1.0 - 1e-3) << "nothing happened";
  EXPECT_NEAR(left, image, 1e-7);
}

}  // namespace
}  // namespace monolith
