// Laminar flow in a square duct, driven by gravity: flow rate and largest velocity of the Fourier series.

#include <cmath>

#include "physics/creeping.h"

namespace monolith {
namespace {

std::vector<Measurement> run(const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across);
  const double h = 1.0 / cells;
  Scene scene = creepingScene({4.0 * h, 1.0, 1.0}, h, numerics);
  scene.tank.periodic[0] = true;
  scene.gravity = {1e-3, 0.0, 0.0};
  Simulation simulation(scene);
  const double G = scene.liquid.density * scene.gravity[0];
  const double mean = steadyValue(simulation, meter, [&](const StepReport& r) {
    return r.liquid_momentum[0] / (scene.liquid.density * scene.tank.size.prod());
  });
  const double middle = simulation.liquidVelocity({2.0 * h, 0.5, 0.5})[0];
  const double goal = cells >= 32.0 ? 0.005 : cells >= 16.0 ? 0.02 : 0.0;
  return {{"mean velocity, m/s", mean, 0.035144 * G, goal}, {"largest velocity, m/s", middle, 0.073671 * G, goal}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  Sweep sweep;
  sweep.base.cells_across = 32.0;
  sweep.cells = extent == Extent::kQuick ? std::vector<double>{8, 16} : std::vector<double>{8, 16, 32, 64};
  addSweep("square duct", sweep, run, out);
  return out;
}

}  // namespace

Case squareDuct() {
  Case c;
  c.name = "duct";
  c.title = "laminar flow in a square duct";
  c.reference = "Fourier series";
  c.across = "side";
  c.steady = true;
  c.variants = variants;
  c.orders = {{"square duct", "mean velocity, m/s", false, 1.7}};
  return c;
}

}  // namespace monolith
