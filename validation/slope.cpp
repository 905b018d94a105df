#include <cmath>
#include <cstdio>

#include "cases.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr double kFriction = 0.5;
constexpr double kDegree = M_PI / 180.0;

// A box on the floor of a tank that is tilted by `angle` about y: gravity turns, the liquid is that of a full, closed
// tank, so that it stays at rest, or none.
Scene slope(double angle, bool wet, double h) {
  Scene scene;
  scene.name = "slope";
  scene.tank.size = {1.0, 0.4, 0.3};
  scene.tank.cell_width = h;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 0.1;
  scene.liquid.fill_level = wet ? 0.3 : 0.0;
  scene.gravity = 9.81 * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  scene.time_step = 0.02;
  scene.contact.friction = kFriction;
  scene.bodies.push_back(boxBody("box", {0.16, 0.16, 0.1}, 2500.0, {0.3, 0.2, 0.05}));
  return scene;
}

// How far the box slides.
double slide(const Scene& scene, double seconds, bool& good) {
  Simulation simulation(scene);
  const double start = simulation.bodyStates()[0].X_WB.translation()[0];
  while (simulation.time() < seconds - 1e-9) {
    const StepReport r = simulation.step();
    if (!r.committed()) {
      std::printf("slope: %s\n", r.message.c_str());
      good = false;
      break;
    }
  }
  return simulation.bodyStates()[0].X_WB.translation()[0] - start;
}

// The angle at which it begins to move, by bisection.
double threshold(bool wet, double h, bool& good) {
  double low = 20.0, high = 35.0;
  while (high - low > 0.02) {
    const double middle = 0.5 * (low + high);
    (slide(slope(middle * kDegree, wet, h), 0.4, good) > 1e-6 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

bool runSlope() {
  bool good = true;
  const double exact = std::atan(kFriction) / kDegree;
  for (const bool wet : {false, true}) {
    const double found = threshold(wet, 0.05, good);
    good = good && std::abs(found - exact) < 0.1;
    std::printf("box on a slope, %s: slides from %.2f degrees, friction angle %.2f, goal 0.1  %s\n", wet ? "wet" : "dry",
                found, exact, std::abs(found - exact) < 0.1 ? "met" : "MISSED");
    const double drift = slide(slope((exact - 0.5) * kDegree, wet, 0.05), 60.0, good);
    good = good && std::abs(drift) < 1e-6;
    std::printf("box on a slope, %s: 0.5 degrees below, moves %.2e m in 60 s, goal 1e-6  %s\n", wet ? "wet" : "dry",
                drift, std::abs(drift) < 1e-6 ? "met" : "MISSED");
  }
  const double angle = exact + 10.0;
  const double a = 9.81 * (std::sin(angle * kDegree) - kFriction * std::cos(angle * kDegree));
  const double seconds = 0.4;
  // Backward Euler with steps dt covers a dt^2 n (n + 1)/2.
  const double steps = seconds / 0.02;
  const double expected = 0.5 * a * 0.02 * 0.02 * steps * (steps + 1.0);
  const double distance = slide(slope(angle * kDegree, false, 0.05), seconds, good);
  return report("box on a slope, dry, 10 degrees above", "distance m", distance, expected, 1e-3) && good;
}

}  // namespace monolith
