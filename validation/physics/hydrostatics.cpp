// Liquid at rest: it stays so, lifts a sphere by its weight, and carries a floating box at Archimedes' draught.

#include <algorithm>
#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

Scene stillTank(double side, double h, double level, double viscosity, const Numerics& numerics) {
  Scene scene;
  scene.name = "still";
  scene.tank.size = Eigen::Vector3d::Constant(side);
  scene.tank.cell_width = h;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = level;
  scene.time_step = 0.05;
  apply(numerics, scene);
  return scene;
}

std::vector<Measurement> rest(double level, double viscosity, const Numerics& numerics, Meter& meter) {
  const double side = 0.16;
  Simulation simulation(stillTank(side, side / std::round(numerics.cells_across), level * side, viscosity, numerics));
  double fastest = 0.0;
  meter.advance(simulation, 10.0, [&](const StepReport& r) { fastest = std::max(fastest, r.maximum_speed); });
  return {{"largest speed in 10 s, m/s", fastest, 0.0, 1e-8, 1.0}};
}

std::vector<Measurement> buoyancy(const Eigen::Vector3d& offset, double viscosity, const Numerics& numerics,
                                  Meter& meter) {
  const double radius = 0.04;
  const double h = 2.0 * radius / std::round(numerics.cells_across);
  Scene scene = stillTank(0.16, h, 0.16, viscosity, numerics);
  scene.bodies.push_back(sphereBody("sphere", radius, 500.0, Eigen::Vector3d::Constant(0.08) + h * offset));
  scene.bodies[0].motion = BodyMotion::kFixed;
  Simulation simulation(scene);
  meter.step(simulation);
  const double expected = 1000.0 * 9.81 * volume(scene.bodies[0].shapes[0]);
  return {{"buoyancy, N", simulation.bodyStates()[0].liquid.force[2], expected, 0.01}};
}

std::vector<Measurement> draught(double density, const Numerics& numerics, Meter& meter) {
  const Eigen::Vector3d size(0.1, 0.1, 0.06);
  const double side = 0.24, depth = 0.12, area = side * side;
  const double h = size[2] / std::round(numerics.cells_across);
  Scene scene = stillTank(side, h, depth, 1.0, numerics);
  scene.time_step = 0.02;
  apply(numerics, scene);
  // Nearly as deep as it will be, or it would dip under: liquid on its top takes its time to run off. The liquid at the
  // start is what it leaves.
  constexpr double kAtStart = 0.8;
  const double expected = density / 1000.0 * size[2];
  const double level = (depth * area + (1.0 - kAtStart) * expected * size[0] * size[1]) / area;
  const double start = depth - kAtStart * expected + 0.5 * size[2];
  scene.bodies.push_back(boxBody("box", size, density, {0.1237, 0.1181, start}));
  Simulation simulation(scene);
  meter.advance(simulation, 12.0);
  const double bottom = simulation.bodyStates()[0].X_WB.translation()[2] - 0.5 * size[2];
  return {{"draught, m, of a cell", level - bottom, expected, 0.05, h}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  const bool full = extent == Extent::kFull;
  char name[80];
  for (const double viscosity : {0.0, 1.0}) {
    for (const double level : {4.5, 4.5004, 4.502, 5.0, 5.37, 5.9999, 16.0}) {  // sixteenths; 16: full, closed
      if (!full && level != 5.37) continue;
      Sweep sweep;
      sweep.base.cells_across = 16.0;
      sweep.fractions = full;
      std::snprintf(name, sizeof name, "still, viscosity %g, %g/16 full", viscosity, level);
      addSweep(
          name, sweep, [=](const Numerics& n, Meter& meter) { return rest(level / 16.0, viscosity, n, meter); }, out);
    }
    const Eigen::Vector3d offsets[] = {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {0.25, 0.1, 0.4}, {0.37, 0.21, 0.08}};
    for (int o = 0; o < 4; ++o) {
      if (!full && (o != 2 || viscosity == 0.0)) continue;
      Sweep sweep;
      sweep.cells = full ? std::vector<double>{4, 8, 16} : std::vector<double>{4, 8};
      sweep.fractions = full;
      const Eigen::Vector3d offset = offsets[o];
      std::snprintf(name, sizeof name, "sphere, viscosity %g, position %d", viscosity, o + 1);
      addSweep(
          name, sweep, [=](const Numerics& n, Meter& meter) { return buoyancy(offset, viscosity, n, meter); }, out);
    }
  }
  for (const double density : {300.0, 500.0, 800.0}) {
    if (!full) continue;
    Sweep sweep;
    sweep.base.cells_across = 6.0;
    std::snprintf(name, sizeof name, "floating box, density %g", density);
    addSweep(
        name, sweep, [=](const Numerics& n, Meter& meter) { return draught(density, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case hydrostatics() {
  Case c;
  c.name = "hydrostatics";
  c.title = "a still tank, the buoyancy of a sphere, the draught of a floating box";
  c.reference = "Archimedes";
  c.across = "tank, diameter, height of the box";
  c.variants = variants;
  return c;
}

}  // namespace monolith
