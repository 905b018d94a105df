// A sphere that is let go in viscous liquid: buoyancy, added mass, and the drag of the layer that grows about it
// (Basset 1888). Early on, before the layer feels the walls.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

// v/v_Stokes at nu t/a^2 of spheres of density rho_s/rho_f in unbounded liquid, exact (creeping).
struct Row {
  double density, early, late;
};
constexpr double kEarly = 0.03, kLate = 0.1;  // nu t/a^2
constexpr Row kRows[] = {{0.1, 0.102642, 0.214984}, {0.5, 0.079544, 0.18385}};

std::vector<Measurement> run(const Row& row, TimeStepping scheme, const Numerics& numerics, Meter& meter) {
  constexpr double kRatio = 0.2;  // radius over half side
  const double cells = 2.0 * std::round(0.5 * numerics.cells_across / kRatio);
  meter.setCellsAcross(kRatio * cells);
  const double radius = 0.5 * kRatio;
  Scene scene;
  scene.source = "unsteady drag";
  scene.tank.cell_width = 1.0 / cells;
  scene.tank.origin.setZero();
  scene.liquid.fill_level = 1.0;
  scene.liquid.density = 1.0;
  scene.liquid.dynamic_viscosity = 1.0;
  scene.gravity = {0.0, 0.0, -1.0};
  apply(numerics, scene);
  scene.solver.time_stepping = scheme;
  scene.time_step = numerics.dt * radius * radius;
  scene.bodies.push_back(sphereBody("sphere", radius, row.density, Eigen::Vector3d::Constant(0.5)));
  Simulation simulation(scene);
  const double stokes = 2.0 / 9.0 * (1.0 - row.density) * radius * radius;
  const auto speed = [&](double time) {
    meter.advance(simulation, time * radius * radius);
    return simulation.bodyStates()[0].velocity[2] / stokes;
  };
  const double goal = numerics.cells_across >= 10.0 && scheme == TimeStepping::kBdf2 ? 0.05 : 0.0;
  const double early = speed(kEarly);
  return {{"speed at nu t/a^2 = 0.03, of Stokes'", early, row.early, goal},
          {"speed at nu t/a^2 = 0.1, of Stokes'", speed(kLate), row.late, goal}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const Row& row : kRows) {
    for (const TimeStepping scheme : {TimeStepping::kBdf2, TimeStepping::kBackwardEuler}) {
      if (!full && (row.density != 0.5 || scheme != TimeStepping::kBdf2)) continue;
      Sweep sweep;
      sweep.base.cells_across = full ? 10.0 : 6.0;
      sweep.base.dt = 0.01;  // a^2/nu
      if (full) {
        sweep.cells = {6, 10, 16};
        sweep.steps = {0.03, 0.005, 0.0025};
      }
      char name[64];
      std::snprintf(name, sizeof name, "density ratio %g, %s", row.density,
                    scheme == TimeStepping::kBdf2 ? "bdf2" : "backward Euler");
      addSweep(
          name, sweep,
          [&row, scheme](const Numerics& numerics, Meter& meter) { return run(row, scheme, numerics, meter); }, out);
    }
  }
  return out;
}

}  // namespace

Case unsteadyDrag() {
  Case c;
  c.name = "unsteady_drag";
  c.title = "a light sphere starts to rise in viscous liquid";
  c.reference = "Boussinesq & Basset, exact in creeping unbounded flow";
  c.across = "diameter";
  c.variants = variants;
  return c;
}

}  // namespace monolith
