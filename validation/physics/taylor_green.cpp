// Plane Taylor-Green vortices in a periodic box: u = sin kx cos kz, w = -cos kx sin kz decay as e^(-2 nu k^2 t),
// whatever the Reynolds number. What is lost beyond that, is lost by advection.

#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

constexpr double kWave = 2.0 * M_PI;

std::vector<Measurement> run(double viscosity, const Numerics& numerics, Meter& meter) {
  const double h = 1.0 / (2.0 * std::round(0.5 * numerics.cells_across));
  Scene scene = creepingScene({1.0, 4.0 * h, 1.0}, h, numerics);
  for (bool& periodic : scene.tank.periodic) periodic = true;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = numerics.dt;
  scene.solver.cfl = SolverDescription().cfl;  // as users have it
  Simulation simulation(scene);
  const auto exact = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(std::sin(kWave * x[0]) * std::cos(kWave * x[2]), 0.0,
                           -std::cos(kWave * x[0]) * std::sin(kWave * x[2]));
  };
  simulation.setLiquidVelocity(exact);
  const double start = 0.25 * scene.tank.size.prod();  // J, of the exact field
  const double time = 0.5;
  double energy = 0.0;
  meter.advance(simulation, time, [&](const StepReport& r) { energy = r.kinetic_energy; });
  const double expected = std::exp(-4.0 * viscosity * kWave * kWave * time);
  double error = 0.0;
  const int n = static_cast<int>(std::lround(1.0 / h));
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d x((i + 0.5) * h, 0.5 * h, (k + 0.5) * h);
      error += (simulation.liquidVelocity(x) - std::sqrt(expected) * exact(x)).squaredNorm();
    }
  }
  const double rms = std::sqrt(error / (n * n)) / std::sqrt(0.5 * expected);
  const double goal = viscosity >= 0.01 && n >= 64 ? 0.02 : 0.0;
  return {{"kinetic energy at 0.5 s, of the start's", energy / start, expected, goal},
          {"rms error of the velocity, of its rms", rms, 0.0, goal, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const double viscosity : {0.01, 0.001}) {
    if (!full && viscosity != 0.01) continue;
    Sweep sweep;
    sweep.base.cells_across = full ? 64.0 : 32.0;
    sweep.base.dt = 0.0125;
    sweep.cells = full ? std::vector<double>{16, 32, 64, 128} : std::vector<double>{16, 32};
    for (const double dt : {0.05, 0.025, 0.00625}) {
      if (full || dt == 0.025) sweep.steps.push_back(dt);
    }
    char name[32];
    std::snprintf(name, sizeof name, "Re %g", 1.0 / viscosity);
    addSweep(
        name, sweep, [viscosity](const Numerics& n, Meter& meter) { return run(viscosity, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case taylorGreen() {
  Case c;
  c.name = "vortices";
  c.title = "decay of plane Taylor-Green vortices";
  c.reference = "analytic";
  c.across = "wavelength";
  c.variants = variants;
  return c;
}

}  // namespace monolith
