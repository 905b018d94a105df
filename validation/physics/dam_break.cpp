// A square column of liquid that is let go in an empty channel: how fast its front runs and its back falls (Martin and
// Moyce 1952, Phil. Trans. R. Soc. A 244, 312, column of base a and height a). The gate of the experiment delays its
// start by an unknown time: the front's speed once it runs is compared, not its place.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kBase = 0.05715;  // m, of the column

struct Line {
  double n = 0.0, t = 0.0, x = 0.0, tt = 0.0, tx = 0.0;
  void add(double time, double value) {
    n += 1.0;
    t += time;
    x += value;
    tt += time * time;
    tx += time * value;
  }
  double slope() const { return (n * tx - t * x) / (n * tt - t * t); }
};

std::vector<Measurement> run(TimeStepping scheme, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across), h = kBase / cells;
  Scene scene;
  scene.source = "dam break";
  scene.tank.cell_width = h;
  scene.tank.origin.setZero();
  scene.tank.size = h * Eigen::Vector3d(std::ceil(5.5 * cells), 4.0, std::ceil(1.4 * cells));
  scene.tank.periodic[1] = true;
  scene.liquid.dynamic_viscosity = 1e-3;
  scene.liquid.boxes.emplace_back(Eigen::Vector3d::Zero(), Eigen::Vector3d(kBase, 4.0 * h, kBase));
  apply(numerics, scene);
  scene.solver.time_stepping = scheme;
  Simulation simulation(scene);
  const double unit = std::sqrt(kBase / 9.81);
  Line front;
  double start = 0.0, shifted = 0.0, height = 1.0;
  meter.advance(simulation, 3.2 * unit, [&](const StepReport& r) {
    if (r.step == 1) start = r.liquid_volume;
    shifted += r.volume_correction / start;
    double reach = 0.0, at_wall = 0.0;
    for (const SurfacePoint& p : simulation.surfacePoints()) {
      reach = std::max(reach, static_cast<double>(p.position[0]));
      if (p.position[0] < h) at_wall = std::max(at_wall, static_cast<double>(p.position[2]));
    }
    const double time = r.time / unit;
    if (time >= 1.0) front.add(time, reach / kBase);
    if (time <= 1.74) height = at_wall / kBase;
  });
  return {{"speed of the front on T = 1 .. 3.2", front.slope(), 1.40},
          {"height at the wall at T = 1.74", height, 0.67},
          {"net shift of the surface, of the volume", shifted, 0.0, 0.0, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const TimeStepping scheme : {TimeStepping::kBdf2, TimeStepping::kBackwardEuler}) {
    if (!full && scheme != TimeStepping::kBdf2) continue;
    Sweep sweep;
    sweep.base.cells_across = full ? 24.0 : 12.0;
    sweep.base.dt = 0.002;
    if (full) {
      sweep.cells = {12, 24, 48};
      sweep.steps = {0.008, 0.004};
    }
    addSweep(
        scheme == TimeStepping::kBdf2 ? "square column, bdf2" : "square column, backward Euler", sweep,
        [scheme](const Numerics& numerics, Meter& meter) { return run(scheme, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case damBreak() {
  Case c;
  c.name = "dam";
  c.title = "a column of water collapses";
  c.reference = "Martin & Moyce 1952";
  c.across = "base of the column";
  c.variants = variants;
  return c;
}

}  // namespace monolith
