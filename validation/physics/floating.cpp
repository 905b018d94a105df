// Bodies that float: heave of a half-immersed sphere (Kramer et al. 2021, Energies 14, 269), roll of a sphere whose
// mass lies below its centre, and the tilt at which a long square bar comes to rest.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kGravity = 9.81;

Scene tankOf(const Eigen::Vector3d& cells, double h, double depth, double viscosity, double dt,
             const Numerics& numerics) {
  Scene scene;
  scene.source = "floating";
  scene.tank.cell_width = h;
  scene.tank.size = h * cells;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = depth;
  scene.time_step = dt;
  apply(numerics, scene);
  return scene;
}

// Twice the mean time between passages of `value` through zero, until `until` (s).
double period(Simulation& simulation, Meter& meter, double until, const std::function<double()>& value) {
  double last = value(), first = 0.0, latest = 0.0;
  int zeros = 0;
  meter.advance(simulation, until, [&](const StepReport& r) {
    const double now = value();
    if (now * last < 0.0) {
      latest = r.time - meter.dt() * now / (now - last);
      if (zeros++ == 0) first = latest;
    }
    last = now;
  });
  return zeros > 1 ? 2.0 * (latest - first) / (zeros - 1) : 0.0;
}

// Lifted by a tenth of its diameter and let go; ends before its waves come back from the walls.
std::vector<Measurement> heave(const Numerics& numerics, Meter& meter) {
  constexpr double kRadius = 0.15, kDepth = 0.9;  // m
  const double h = 2.0 * kRadius / std::round(numerics.cells_across);
  const double side = 2.0 * std::round(0.8 / h);
  Scene scene = tankOf({side, side, std::ceil(1.15 / h)}, h, kDepth, 0.0, 0.02, numerics);
  scene.liquid.density = 998.2;
  scene.bodies.push_back(sphereBody("sphere", kRadius, 0.5 * scene.liquid.density,
                                    {0.5 * side * h, 0.5 * side * h, kDepth + 0.2 * kRadius}));
  Simulation simulation(scene);
  const double found = period(simulation, meter, 1.6, [&] {
    return simulation.bodyStates()[0].X_WB.translation()[2] - kDepth;
  });
  return {{"period, s", found, 0.76, 0.05}};
}

// In an inviscid liquid a sphere turns without it; its sway drags a little liquid along.
std::vector<Measurement> roll(const Numerics& numerics, Meter& meter) {
  constexpr double kRadius = 0.05, kDrop = 0.1 * kRadius, kTilt = 10.0 * M_PI / 180.0;
  const double h = 2.0 * kRadius / std::round(numerics.cells_across);
  const double side = 2.0 * std::round(0.1 / h), depth = h * std::round(0.12 / h);
  Scene scene = tankOf({side, side, std::ceil(0.2 / h)}, h, depth, 0.0, 0.02, numerics);
  BodyDescription sphere =
      sphereBody("sphere", kRadius, 0.5 * scene.liquid.density, {0.5 * side * h, 0.5 * side * h, depth});
  sphere.p_BBcm = {0.0, 0.0, -kDrop};
  sphere.X_WB.rotate(Eigen::AngleAxisd(kTilt, Eigen::Vector3d::UnitY()));
  scene.bodies.push_back(sphere);
  Simulation simulation(scene);
  const double found =
      period(simulation, meter, 3.0, [&] { return simulation.bodyStates()[0].X_WB.linear()(0, 2); });
  // Sway added mass of a half-immersed sphere, of its mass, at this frequency: between 0.27 and 0.6 (Hulme 1982, J.
  // Fluid Mech. 121, 443); it moves the period by less than 0.2 %.
  constexpr double kSway = 0.5;
  const double per_mass = sphere.inertia_Bcm(1, 1) / sphere.mass + kDrop * kDrop * kSway / (1.0 + kSway);
  const double amplitude = 1.0 + kTilt * kTilt / 16.0;
  return {{"period, s", found, amplitude * 2.0 * M_PI * std::sqrt(per_mass / (kGravity * kDrop)), 0.03}};
}

// A bar along a periodic axis, turned by 20 degrees and left to itself in a viscous liquid.
std::vector<Measurement> tilt(double specific_gravity, double expected, const Numerics& numerics, Meter& meter) {
  constexpr double kSide = 0.1;
  const double h = kSide / std::round(numerics.cells_across);
  const double wide = 2.0 * std::round(0.2 / h), depth = h * std::round(0.14 / h);
  Scene scene = tankOf({wide, 4.0, std::ceil(0.26 / h)}, h, depth, 5.0, 0.02, numerics);
  scene.tank.periodic[1] = true;
  BodyDescription bar = boxBody("bar", {kSide, scene.tank.size[1], kSide}, specific_gravity * scene.liquid.density,
                                {0.5 * wide * h, 0.5 * scene.tank.size[1], depth});
  // Slow about the other axes: an endless bar cannot pitch.
  bar.inertia_Bcm(0, 0) = bar.inertia_Bcm(2, 2) = 1e6 * bar.inertia_Bcm(1, 1);
  bar.X_WB.rotate(Eigen::AngleAxisd(20.0 * M_PI / 180.0, Eigen::Vector3d::UnitY()));
  scene.bodies.push_back(bar);
  Simulation simulation(scene);
  meter.advance(simulation, 10.0);
  const Eigen::Matrix3d R = simulation.bodyStates()[0].X_WB.linear();
  const double found = std::abs(std::remainder(std::atan2(R(0, 2), R(2, 2)) * 180.0 / M_PI, 90.0));
  return {{"tilt, degrees (error: of 45)", found, expected, 0.05, 45.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  const bool full = extent == Extent::kFull;
  Sweep sweep;
  sweep.base.cells_across = 8.0;
  if (full) sweep.cells = {6, 8, 12};
  if (full) sweep.steps = {0.01, 0.04};
  if (full) addSweep("heave of a sphere", sweep, heave, out);
  addSweep("roll of a sphere", sweep, roll, out);
  // Equilibria of least potential energy: stable upright for a specific gravity below 0.2113, atan(1/2) at 1/4.
  const std::pair<double, double> bars[] = {{0.15, 0.0}, {0.25, 26.565}, {0.5, 45.0}};
  for (const auto& [specific_gravity, expected] : bars) {
    if (!full && specific_gravity != 0.25) continue;
    char name[64];
    std::snprintf(name, sizeof name, "bar of specific gravity %.2f", specific_gravity);
    const double s = specific_gravity, angle = expected;
    addSweep(
        name, sweep, [=](const Numerics& n, Meter& meter) { return tilt(s, angle, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case floatingBodies() {
  Case c;
  c.name = "floating";
  c.title = "heave and roll period of floating spheres, and the tilt of a floating square bar";
  c.reference = "Kramer et al. 2021, Energies 14, 269; rigid-body pendulum; statics of floating prisms";
  c.across = "diameter, side of the bar";
  c.variants = variants;
  return c;
}

}  // namespace monolith
