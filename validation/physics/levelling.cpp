// Liquid that starts with its surface tilted comes to rest flat, at the level that its volume fills, also around a body
// that stands in it.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kSide = 0.24, kDepth = 0.1, kTilt = 0.25;  // m, m, slope

std::vector<Measurement> run(bool with_body, const Numerics& numerics, Meter& meter) {
  const int cells = static_cast<int>(std::round(numerics.cells_across));
  const double h = kSide / cells;
  Scene scene;
  scene.source = "levelling";
  scene.tank.cell_width = h;
  scene.tank.size = {kSide, kSide, h * std::ceil(0.16 / h)};
  scene.liquid.dynamic_viscosity = 5.0;
  scene.time_step = 0.02;
  for (int i = 0; i < cells; ++i) {
    const double top = kDepth + kTilt * ((i + 0.5) * h - 0.5 * kSide);
    scene.liquid.boxes.emplace_back(Eigen::Vector3d(i * h, 0.0, 0.0), Eigen::Vector3d((i + 1) * h, kSide, top));
  }
  apply(numerics, scene);
  if (with_body) {
    // A pillar through the surface, in the middle: of the tilted liquid it takes as much as of the flat one.
    const Eigen::Vector3d size(0.0737, 0.0737, 0.12);
    scene.bodies.push_back(boxBody("pillar", size, 2000.0, {0.5 * kSide, 0.5 * kSide, 0.5 * size[2] + 0.001}));
    scene.bodies[0].motion = BodyMotion::kFixed;
  }
  Simulation simulation(scene);
  meter.advance(simulation, 12.0);
  double mean = 0.0, least = 1e9, most = -1e9;
  const std::vector<SurfacePoint> points = simulation.surfacePoints();
  for (const SurfacePoint& p : points) {
    mean += p.position[2] / static_cast<double>(points.size());
    least = std::min(least, static_cast<double>(p.position[2]));
    most = std::max(most, static_cast<double>(p.position[2]));
  }
  return {{"level, m (error: of a cell)", mean, kDepth, 0.05, h},
          {"highest less lowest point, of a cell", (most - least) / h, 0.0, 0.05, 1.0},
          {"speed, m/s", simulation.report().maximum_speed, 0.0, 1e-3, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  const bool full = extent == Extent::kFull;
  for (const bool with_body : {false, true}) {
    Sweep sweep;
    sweep.base.cells_across = 16.0;
    if (full) sweep.cells = {16, 24, 32};
    if (full) sweep.steps = {0.01, 0.04};
    if (!full && with_body) continue;
    addSweep(
        with_body ? "around a pillar" : "free", sweep,
        [with_body](const Numerics& numerics, Meter& meter) { return run(with_body, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case levelling() {
  Case c;
  c.name = "levelling";
  c.title = "a tilted surface comes to rest flat, at the level of its volume";
  c.reference = "statics";
  c.across = "side of the tank";
  c.variants = variants;
  return c;
}

}  // namespace monolith
