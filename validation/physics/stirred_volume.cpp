// The shipped scene `drop` for a minute: bodies of several densities fall into a tank and stir it. How much liquid is
// left, how much of it only because the surface was shifted to keep it, and how deep bodies sink into each other.

#include <algorithm>
#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"
#include "scene/scene_file.h"

namespace monolith {
namespace {

std::vector<Measurement> run(double seconds, const Numerics& numerics, Meter& meter) {
  Scene scene = loadScene(shippedScene("drop"), {});
  const double h = scene.tank.size[2] / std::round(numerics.cells_across);
  scene.tank.cell_width = h;
  apply(numerics, scene);
  Simulation simulation(scene);
  double start = 0.0, end = 0.0, drift = 0.0, shifted = 0.0, depth = 0.0;
  meter.advance(simulation, seconds, [&](const StepReport& r) {
    if (r.step == 1) start = r.liquid_volume;
    end = r.liquid_volume;
    drift = std::max(drift, std::abs(r.liquid_volume / start - 1.0));
    shifted += std::abs(r.volume_correction) / start;
    depth = std::max(depth, r.penetration);
  });
  return {{"volume at the end, m^3", end, start, 0.002},
          {"largest drift of the volume, of it", drift, 0.0, 0.002, 1.0},
          {"shifted back in all, of it", shifted, 0.0, 0.0, 1.0},
          {"deepest penetration, of a cell", depth / h, 0.0, 0.05, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  const Scene scene = loadScene(shippedScene("drop"), {});
  Sweep sweep;
  sweep.base.cells_across = std::round(scene.tank.size[2] / scene.tank.cell_width);
  if (!full) sweep.base.cells_across *= 0.5;
  const double seconds = full ? 60.0 : 2.0;
  std::vector<Variant> out;
  addSweep(
      full ? "drop, 60 s" : "drop, 2 s", sweep,
      [seconds](const Numerics& numerics, Meter& meter) { return run(seconds, numerics, meter); }, out);
  return out;
}

}  // namespace

Case stirredVolume() {
  Case c;
  c.name = "volume";
  c.title = "liquid volume and penetration over a minute of the scene drop";
  c.reference = "conservation";
  c.across = "height of the tank";
  c.variants = variants;
  return c;
}

}  // namespace monolith
