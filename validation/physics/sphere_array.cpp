// Stokes drag of a simple cubic array of spheres: one sphere, fixed in a periodic cell of edge 1 through which gravity
// drives the liquid. K = F/(6 pi mu a U), U the superficial velocity.

#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

// K = sum of q_s chi^s, chi = (c/c_max)^(1/3), c_max = pi/6. Sangani & Acrivos 1982, Int. J. Multiphase Flow 8, 343,
// table 1; agrees with Zick & Homsy 1982 to 0.02 % for c <= 0.216.
double exactFactor(double fraction) {
  constexpr double q[] = {1,         1.418649,  2.012564,   2.331523,  2.564809, 2.584787, 2.873609, 3.340163,
                          3.536763,  3.504092,  3.253622,   2.689757,  2.037769, 1.809341, 1.877347, 1.534685,
                          0.9034708, 0.2857896, -0.5512626, -1.278724, 1.01335,  5.492491, 4.615388, -0.5736023,
                          -2.865924, -4.709215, -6.870076,  0.1455304, 12.51891, 9.742811, -5.566269};
  const double chi = std::cbrt(fraction / (M_PI / 6.0));
  double K = 0.0, power = 1.0;
  for (const double coefficient : q) {
    K += coefficient * power;
    power *= chi;
  }
  return K;
}

std::vector<Measurement> run(double diameter, const Eigen::Vector3d& offset_cells, const Numerics& numerics,
                             Meter& meter) {
  const double cells = 2.0 * std::round(0.5 * numerics.cells_across / diameter);
  const double h = 1.0 / cells;
  meter.setCellsAcross(diameter * cells);
  Scene scene = creepingScene(Eigen::Vector3d::Ones(), h, numerics);
  for (bool& periodic : scene.tank.periodic) periodic = true;
  scene.gravity = Eigen::Vector3d(0.0, 0.0, 1e-8);
  scene.bodies.push_back(sphereBody("sphere", 0.5 * diameter, 1.0, Eigen::Vector3d::Constant(0.5) + h * offset_cells));
  scene.bodies[0].motion = BodyMotion::kFixed;
  Simulation simulation(scene);
  const double driven = scene.liquid.density * scene.gravity[2];
  const double solid = volume(scene.bodies[0].shapes[0]);
  const double found = steadyValue(simulation, meter, [&](const StepReport& r) {
    // The mean pressure gradient pushes the sphere's own volume too.
    const double force = simulation.bodyStates()[0].liquid.force[2] + driven * solid;
    return force / (6.0 * M_PI * scene.liquid.dynamic_viscosity * 0.5 * diameter * r.liquid_momentum[2]);
  });
  return {{"drag factor", found, exactFactor(solid), dragGoal(diameter * cells)}};
}

std::vector<Variant> variants(Extent extent) {
  const Eigen::Vector3d offsets[] = {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {0.25, 0.1, 0.4}, {0.37, 0.21, 0.08}};
  std::vector<Variant> out;
  for (const double diameter : {0.25, 1.0 / 3.0, 0.5, 0.625}) {
    for (int o = 0; o < 4; ++o) {
      if (extent == Extent::kQuick && (diameter != 0.5 || o % 2 == 1)) continue;
      Sweep sweep;
      sweep.base.cells_across = 10.0;
      sweep.cells = extent == Extent::kQuick ? std::vector<double>{4, 10} : std::vector<double>{4, 6, 8, 10, 16};
      if (diameter == 0.625) sweep.cells = {5, 10, 15, 20};  // even numbers of cells
      if (extent == Extent::kFull && o == 2 && diameter == 0.5) {
        sweep.tolerances = {1e-2, 1e-3, 1e-4, 1e-6};
        sweep.fractions = true;
      }
      char name[64];
      std::snprintf(name, sizeof name, "fraction %.3f, position %d", M_PI / 6.0 * std::pow(diameter, 3), o + 1);
      const Eigen::Vector3d offset = offsets[o];
      addSweep(
          name, sweep, [=](const Numerics& numerics, Meter& meter) { return run(diameter, offset, numerics, meter); },
          out);
    }
  }
  return out;
}

}  // namespace

Case sphereArray() {
  Case c;
  c.name = "array";
  c.title = "Stokes drag of a cubic array of spheres, four positions in the grid";
  c.reference = "Sangani & Acrivos 1982, Int. J. Multiphase Flow 8, 343; Zick & Homsy 1982, J. Fluid Mech. 115, 13";
  c.across = "diameter";
  c.steady = true;
  c.variants = variants;
  return c;
}

}  // namespace monolith
