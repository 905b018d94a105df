// A sphere that settles in a closed tank of silicone oil: ten Cate, Nieuwstad, Derksen & Van den Akker 2002, Phys. Fluids 14,
// 4012. The shipped scene is their case E1.

#include <algorithm>
#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"
#include "scene/scene_file.h"

namespace monolith {
namespace {

constexpr double kDiameter = 0.015;

struct Experiment {
  const char* name;
  double density, viscosity;  // of the oil
  double peak;                // m/s: u_max/u_inf of their table II times u_inf of table I
  double duration;            // s
};
// u_inf: E1 0.038, E3 0.091 m/s, both rounded to two digits there; recomputed by Abraham's correlation.
constexpr Experiment kExperiments[] = {{"E1", 970.0, 0.373, 0.947 * 0.03829, 4.2}, {"E3", 962.0, 0.113, 0.959 * 0.09062, 1.9}};

std::vector<Measurement> run(const Experiment& experiment, const Numerics& numerics, Meter& meter) {
  Scene scene = loadScene(shippedScene("settling_sphere"), {});
  scene.tank.cell_width = kDiameter / numerics.cells_across;
  for (int a = 0; a < 3; ++a) {
    // Whole cells: 100 x 100 x 160 mm to within half a cell of the outermost, the sphere on the axis.
    const double cells = std::round(scene.tank.size[a] / scene.tank.cell_width);
    scene.tank.cell_width = scene.tank.cell_width;
    scene.tank.size[a] = cells * scene.tank.cell_width;
    if (a < 2) scene.tank.origin[a] = -0.5 * scene.tank.size[a];
  }
  scene.liquid.fill_level = scene.tank.size[2];
  scene.liquid.density = experiment.density;
  scene.liquid.dynamic_viscosity = experiment.viscosity;
  apply(numerics, scene);
  Simulation simulation(scene);
  double peak = 0.0, at_peak = 0.0;
  meter.advance(simulation, experiment.duration, [&](const StepReport& r) {
    const double speed = -simulation.bodyStates()[0].velocity[2];
    if (speed > peak) at_peak = r.time;
    peak = std::max(peak, speed);
  });
  (void)at_peak;
  const double goal = numerics.cells_across >= 12.0 ? 0.01 : numerics.cells_across >= 8.0 ? 0.02 : 0.0;
  return {{"peak speed, m/s", peak, experiment.peak, goal}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const Experiment& experiment : kExperiments) {
    if (extent == Extent::kQuick) continue;
    Sweep sweep;
    sweep.base.cells_across = 6.0;
    sweep.base.dt = 0.02;
    sweep.cells = {4, 6, 9, 12};
    addSweep(
        experiment.name, sweep,
        [&experiment](const Numerics& numerics, Meter& meter) { return run(experiment, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case settlingSphere() {
  Case c;
  c.name = "settling";
  c.title = "a sphere settles in a closed tank: peak speed and trajectory";
  c.reference = "ten Cate et al. 2002, Phys. Fluids 14, 4012, cases E1 and E3";
  c.across = "diameter";
  c.variants = variants;
  return c;
}

}  // namespace monolith
