// A box on a slope, dry and in liquid that is at rest: the angle at which it begins to slide, that it rests below it,
// and how far it slides above it. The tank is tilted: gravity turns.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kFriction = 0.5;
constexpr double kDegree = M_PI / 180.0;
const double kThreshold = std::atan(kFriction) / kDegree;
constexpr double kBox = 0.16;

Scene tilted(double angle, bool wet, const Numerics& numerics) {
  Scene scene;
  scene.name = "slope";
  scene.tank.size = {1.0, 0.4, 0.3};
  scene.tank.cell_width = 0.1 / std::round(0.1 / kBox * numerics.cells_across);
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 0.1;
  scene.liquid.fill_level = wet ? 0.3 : 0.0;
  scene.gravity = 9.81 * Eigen::Vector3d(std::sin(angle * kDegree), 0.0, -std::cos(angle * kDegree));
  scene.time_step = 0.02;
  scene.contact.friction = kFriction;
  scene.bodies.push_back(boxBody("box", {kBox, kBox, 0.1}, 2500.0, {0.3, 0.2, 0.05}));
  apply(numerics, scene);
  return scene;
}

// How far the box slides.
double slide(const Scene& scene, double seconds, Meter& meter) {
  Simulation simulation(scene);
  const double start = simulation.bodyStates()[0].X_WB.translation()[0];
  meter.advance(simulation, seconds);
  return simulation.bodyStates()[0].X_WB.translation()[0] - start;
}

std::vector<Measurement> run(bool wet, const Numerics& numerics, Meter& meter) {
  double low = 20.0, high = 35.0;
  while (high - low > 0.02) {
    const double middle = 0.5 * (low + high);
    (slide(tilted(middle, wet, numerics), 0.4, meter) > 1e-6 ? high : low) = middle;
  }
  const double drift = slide(tilted(kThreshold - 0.5, wet, numerics), 60.0, meter);
  std::vector<Measurement> out = {{"threshold, degrees", 0.5 * (low + high), kThreshold, 0.1 / kThreshold},
                                  {"drift in 60 s half a degree below, m", drift, 0.0, 1e-6, 1.0}};
  if (wet) return out;
  const double angle = kThreshold + 10.0;
  const Scene sliding = tilted(angle, false, numerics);
  const double a = 9.81 * (std::sin(angle * kDegree) - kFriction * std::cos(angle * kDegree));
  const double seconds = 0.4;
  const double distance = slide(sliding, seconds, meter);
  out.push_back({"distance slid 10 degrees above, m", distance, 0.5 * a * seconds * seconds, 1e-3});
  return out;
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const bool wet : {false, true}) {
    if (extent == Extent::kQuick && wet) continue;
    Sweep sweep;
    sweep.base.cells_across = 3.2;
    sweep.base.dt = 0.02;
    if (!wet) sweep.steps = {0.01, 0.005};
    if (wet) sweep.cells = {3.2, 6.4};
    addSweep(
        wet ? "wet" : "dry", sweep, [wet](const Numerics& n, Meter& meter) { return run(wet, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case slope() {
  Case c;
  c.name = "slope";
  c.title = "a box on a slope, dry and wet: threshold of friction, rest below it, distance slid above it";
  c.reference = "Coulomb's law";
  c.across = "edge of the box";
  c.variants = variants;
  return c;
}

}  // namespace monolith
