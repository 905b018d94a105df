// Three cubes on the floor, the heaviest on top: each carries the weight above it, and none moves. Partitioned solvers
// and loose contact solvers sink or shake here.

#include <algorithm>
#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kEdge = 0.06;  // m
constexpr double kLiquid = 1000.0;
constexpr double kGravity = 9.81;
constexpr double kLightest = 1200.0;  // kg/m^3

std::vector<Measurement> run(double ratio, bool wet, const Numerics& numerics, Meter& meter) {
  Scene scene;
  scene.name = "stack";
  scene.tank.cell_width = kEdge / std::round(numerics.cells_across);
  scene.tank.size = {4.0 * kEdge, 4.0 * kEdge, 5.0 * kEdge};
  scene.liquid.density = kLiquid;
  scene.liquid.dynamic_viscosity = 1.0;
  scene.liquid.fill_level = wet ? 4.0 * kEdge : 0.0;
  scene.contact.friction = 0.3;
  scene.time_step = 0.02;
  double weight = 0.0, dry_weight = 0.0;  // N
  for (int i = 0; i < 3; ++i) {
    // The lower two are equally light.
    const double density = i == 2 ? ratio * kLightest : kLightest;
    dry_weight += density * std::pow(kEdge, 3) * kGravity;
    weight += (density - (wet ? kLiquid : 0.0)) * std::pow(kEdge, 3) * kGravity;
    scene.bodies.push_back(boxBody("cube" + std::to_string(i), Eigen::Vector3d::Constant(kEdge), density,
                                   {2.03 * kEdge, 1.98 * kEdge, (i + 0.5) * kEdge}));
  }
  apply(numerics, scene);
  Simulation simulation(scene);
  const auto before = simulation.bodyStates();
  double depth = 0.0, force = 0.0;
  meter.advance(simulation, 5.0, [&](const StepReport& r) { depth = std::max(depth, r.penetration); });
  double moved = 0.0;
  const auto after = simulation.bodyStates();
  for (int i = 0; i < 3; ++i) {
    moved = std::max(moved, (after[i].X_WB.translation() - before[i].X_WB.translation()).norm());
    force += after[i].contact.force[2];  // what the floor gives; between cubes it cancels
  }
  return {{"force on the floor, N (error: of the weight in air)", force, weight, 5e-3, dry_weight},
          {"largest motion in 5 s, m", moved, 0.0, 1e-3, scene.tank.cell_width},
          {"deepest penetration, m", depth, 0.0, 0.05, scene.tank.cell_width}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const bool wet : {false, true}) {
    for (const double ratio : {1.0, 30.0, 1000.0}) {
      if (extent == Extent::kQuick && ratio != 1000.0) continue;
      Sweep sweep;
      sweep.base.cells_across = 4.0;
      sweep.base.dt = 0.02;
      if (extent == Extent::kFull) sweep.steps = {0.04, 0.01};
      const std::string name = std::string(wet ? "wet" : "dry") + ", 1:1:" + std::to_string(static_cast<int>(ratio));
      addSweep(
          name, sweep, [=](const Numerics& n, Meter& meter) { return run(ratio, wet, n, meter); }, out);
    }
  }
  return out;
}

}  // namespace

Case stack() {
  Case c;
  c.name = "stack";
  c.title = "three cubes stacked on the floor, mass ratios to 1000:1, dry and wet";
  c.reference = "statics: the floor carries the (submerged) weight, nothing moves";
  c.across = "edge of a cube";
  c.variants = variants;
  return c;
}

}  // namespace monolith
