// A sphere on a hinge in a closed cubic tank of inviscid liquid, heavier than it and hanging or lighter and standing:
// it swings with the mass of the liquid that it moves, as a pendulum does (D. Neill, D. Livelybrooks, R. J. Donnelly,
// 'A pendulum experiment on added mass and the principle of equivalence', American Journal of Physics 75, 2007),
//   T = 2 pi sqrt(((rho_s + C_m rho_f) L^2 + 2/5 rho_s R^2)/(|rho_s - rho_f| g L)) (1 + amplitude^2/16)

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kDiameter = 0.2, kLength = 0.4;  // m; the tank's side is 1 m
constexpr double kAddedMass = 0.5073;             // of a sphere of that size there: see added_mass.cpp
constexpr double kAmplitude = 0.1;                // rad
constexpr int kSwings = 3;                        // half periods that are measured, after the first quarter
const char* const kPeriod = "period, s";

double exactPeriod(double density, double g) {
  const double inertia = (density + kAddedMass) * kLength * kLength + 0.1 * density * kDiameter * kDiameter;
  return 2.0 * M_PI * std::sqrt(inertia / (std::abs(density - 1.0) * g * kLength)) *
         (1.0 + kAmplitude * kAmplitude / 16.0);
}

Scene pendulum(double density, double cells) {
  Scene scene;
  scene.source = "pendulum";
  scene.tank.cell_width = 1.0 / cells;
  scene.tank.origin.setZero();
  scene.liquid.fill_level = 1.0;
  // Off the grid's symmetry.
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(0.5) + Eigen::Vector3d(0.15, 0.35, 0.3) / cells;
  const Eigen::Vector3d arm(0.0, 0.0, density > 1.0 ? -kLength : kLength);
  const double size = 2.0 / cells;
  BodyDescription base = boxBody("base", Eigen::Vector3d::Constant(size), 1000.0, centre - arm);
  base.motion = BodyMotion::kFixed;
  scene.bodies.push_back(base);
  BodyDescription bob = sphereBody("bob", 0.5 * kDiameter, density * scene.liquid.density, Eigen::Vector3d::Zero());
  bob.p_BBcm = arm;
  bob.shapes[0].X_BG.translation() = arm;
  JointDescription hinge;
  hinge.name = "hinge";
  hinge.axis = Eigen::Vector3d::UnitY();
  hinge.position = kAmplitude;
  hangOn(scene.bodies, 0, bob, hinge);
  return scene;
}

std::vector<Measurement> run(double density, const Numerics& numerics, Meter& meter) {
  const double cells = 2.0 * std::round(0.5 * numerics.cells_across / kDiameter);
  meter.setCellsAcross(kDiameter * cells);
  Scene scene = pendulum(density, cells);
  apply(numerics, scene);
  Simulation simulation(scene);
  const double exact = exactPeriod(density, -scene.gravity[2]);
  std::vector<double> crossings;
  double before = kAmplitude, time = 0.0;
  while (crossings.size() <= kSwings && simulation.time() < 4.0 * exact) {
    meter.step(simulation);
    const double now = simulation.jointStates()[0].position;
    if (now * before <= 0.0) crossings.push_back(time + (simulation.time() - time) * before / (before - now));
    before = now;
    time = simulation.time();
    meter.progress(simulation.time() / (0.5 * exact * (kSwings + 0.5)));
  }
  const double period = crossings.size() > kSwings ? 2.0 * (crossings.back() - crossings.front()) / kSwings : 0.0;
  return {{kPeriod, period, exact, numerics.cells_across >= 10.0 ? 0.01 : 0.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const double density : {0.01, 0.5, 2.0, 8.0}) {
    if (!full && density != 2.0) continue;
    Sweep sweep;
    sweep.base.cells_across = full ? 10.0 : 6.0;
    sweep.base.dt = 0.02;
    if (full) sweep.cells = {6, 10, 16};
    if (full) sweep.steps = {0.04, 0.01};
    char name[48];
    std::snprintf(name, sizeof name, "density ratio %g", density);
    addSweep(
        name, sweep, [density](const Numerics& n, Meter& meter) { return run(density, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case pendulumInLiquid() {
  Case c;
  c.name = "pendulum";
  c.title = "a sphere on a hinge, hanging or buoyant, in a closed cubic tank";
  c.reference = "potential flow";
  c.across = "diameter";
  c.variants = variants;
  return c;
}

}  // namespace monolith
