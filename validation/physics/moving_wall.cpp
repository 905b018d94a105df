// Liquid between a belt and a wall: Couette flow of a steady belt, Stokes' second problem of one that swings, where the
// belt's surface lies anywhere between the grid's faces.

#include <cmath>
#include <complex>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

// Liquid from the belt's surface at z = 0 up to `depth`; the belt is two cells thick and `part` of one.
Scene beltScene(double depth, double cells, double part, const Numerics& numerics) {
  const double h = depth / (cells + 1.0 - part);  // the belt ends `part` into a cell: its rest is liquid
  Scene scene = creepingScene({4.0 * h, 4.0 * h, 0.0}, h, numerics);
  scene.tank.size[2] = (cells + 3.0) * h;
  scene.tank.origin[2] = -(2.0 + part) * h;
  scene.tank.periodic[0] = scene.tank.periodic[1] = true;
  scene.liquid.fill_level = scene.tank.size[2];
  const double thickness = (2.0 + part) * h;
  scene.bodies.push_back(boxBody("belt", {40.0 * h, 40.0 * h, thickness}, 1.0, {2.0 * h, 2.0 * h, -0.5 * thickness}));
  moveInPlace(scene.bodies[0], Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  return scene;
}

std::vector<Measurement> couette(double part, const Numerics& numerics, Meter& meter) {
  const Scene scene = beltScene(1.0, std::round(numerics.cells_across), part, numerics);
  Simulation simulation(scene);
  const double area = scene.tank.size[0] * scene.tank.size[1];
  const double stress = steadyValue(
      simulation, meter, [&](const StepReport&) { return -simulation.bodyStates()[0].liquid.force[0] / area; });
  const double h = scene.tank.cell_width;
  double worst = 0.0;
  for (int k = 0; k < 2 * static_cast<int>(1.0 / h) - 1; ++k) {
    const double z = 1.0 - 0.5 * h * (k + 1);
    worst = std::max(worst, std::abs(simulation.liquidVelocity({2.0 * h, 2.0 * h, z})[0] - (1.0 - z)));
  }
  return {{"stress on the belt, Pa", stress, 1.0, 1e-4}, {"largest error of the velocity", worst, 0.0, 1e-4, 1.0}};
}

// nu = 1, omega = 2: the wave's length of decay is 1. Velocity of the belt cos(omega t), of liquid of depth H above it
// Re(sinh(k (H - z))/sinh(k H) e^(i omega t)), k = 1 + i.
std::vector<Measurement> swing(double part, const Numerics& numerics, Meter& meter) {
  constexpr double kDepth = 4.0, kPeriod = M_PI;
  constexpr int kPeriods = 5;
  Scene scene = beltScene(kDepth, std::round(numerics.cells_across * kDepth), part, numerics);
  meter.setCellsAcross(1.0 / scene.tank.cell_width);
  const double steps = std::round(kPeriod / numerics.dt);  // in a period
  scene.time_step = kPeriod / steps;
  PrescribedMotion& motion = scene.bodies[0].prescribed;
  motion.twist.setZero();
  motion.frequency = 1.0 / kPeriod;
  motion.amplitude[0] = 0.5;  // times omega: 1 m/s
  Simulation simulation(scene);
  meter.advance(simulation, (kPeriods - 1) * kPeriod);
  const double h = scene.tank.cell_width;
  std::complex<double> found = 0.0;
  meter.advance(simulation, kPeriods * kPeriod, [&](const StepReport& r) {
    const double u = simulation.liquidVelocity({2.0 * h, 2.0 * h, 1.0})[0];
    found += 2.0 / steps * u * std::exp(std::complex<double>(0.0, -2.0 * r.time));
  });
  const std::complex<double> k(1.0, 1.0);
  const std::complex<double> exact = std::sinh(k * (kDepth - 1.0)) / std::sinh(k * kDepth);
  const double goal = numerics.cells_across >= 8.0 && steps >= 100.0 ? 0.05 : 0.0;
  return {{"amplitude at one decay length", std::abs(found), std::abs(exact), goal},
          {"amplitude and phase, error of", std::abs(found - exact) / std::abs(exact), 0.0, 0.0, 1.0}};
}

std::vector<Variant> swings(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const double part : {0.0, 0.3, 0.8}) {
    if (!full && part != 0.3) continue;
    Sweep sweep;
    sweep.base.cells_across = 8.0;
    sweep.base.dt = M_PI / 100.0;
    sweep.cells = full ? std::vector<double>{4, 8, 16, 32} : std::vector<double>{8};
    for (const int n : {25, 50, 200, 400}) {
      if (full || n == 50) sweep.steps.push_back(M_PI / n);
    }
    char name[48];
    std::snprintf(name, sizeof name, "surface %g into a cell", part);
    addSweep(
        name, sweep, [part](const Numerics& n, Meter& meter) { return swing(part, n, meter); }, out);
  }
  return out;
}

std::vector<Variant> couettes(Extent extent) {
  std::vector<Variant> out;
  for (const double part : {0.0, 0.01, 0.3, 0.5, 0.8}) {
    Sweep sweep;
    sweep.base.cells_across = 8.0;
    sweep.base.tolerance = 1e-7;  // all the error there is
    if (extent == Extent::kFull) sweep.cells = {4, 8, 16};
    if (extent == Extent::kFull && part == 0.3) sweep.tolerances = {1e-3, 1e-4, 1e-5, 1e-6};
    if (extent == Extent::kFull && part == 0.3) sweep.fractions = true;
    char name[48];
    std::snprintf(name, sizeof name, "surface %g into a cell", part);
    addSweep(
        name, sweep, [part](const Numerics& n, Meter& meter) { return couette(part, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case couetteFlow() {
  Case c;
  c.name = "couette";
  c.title = "plane Couette flow under a belt whose surface lies between the grid's faces";
  c.reference = "analytic";
  c.across = "depth";
  c.steady = true;
  c.variants = couettes;
  return c;
}

Case swingingWall() {
  Case c;
  c.name = "swing";
  c.title = "Stokes' second problem: liquid over a wall that swings along itself";
  c.reference = "analytic, of finite depth";
  c.across = "length of decay";
  c.variants = swings;
  c.orders = {{"surface 0.3 into a cell", "amplitude and phase, error of", true, 0.8}};
  return c;
}

}  // namespace monolith
