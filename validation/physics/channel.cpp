// Plane channels of Newtonian and other liquids, driven by gravity, against the profiles of their laws.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

// Liquid of 1000 kg/m^3 between walls 0.1 m apart, driven along them by 1 m/s^2: 50 Pa at the walls.
constexpr double kWidth = 0.1;
constexpr double kDensity = 1000.0;
constexpr double kGravity = 1.0;
constexpr double kWallStress = 0.5 * kDensity * kGravity * kWidth;
constexpr int kPoints = 200000;  // of the quadratures

struct Channel {
  std::string name;
  RheologyDescription rheology;
  double viscosity = 0.0;                        // of a Newtonian liquid
  std::function<double(double)> rate_of_stress;  // the exact law, 1/s of Pa
};

// The rate at which a law eta(rate) gives a stress, by bisection of its logarithm.
std::function<double(double)> inverted(const std::function<double(double)>& viscosity) {
  return [viscosity](double stress) {
    if (!(stress > 0.0)) return 0.0;
    double low = -60.0, high = 30.0;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      const double rate = std::exp(middle);
      (viscosity(rate) * rate < stress ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  };
}

RheologyDescription powerLaw(double consistency, double index) {
  RheologyDescription r;
  r.law = RheologyDescription::Law::kPowerLaw;
  r.consistency = consistency;
  r.index = index;
  r.minimum_viscosity = 1e-4;
  r.maximum_viscosity = 1e4;
  return r;
}

RheologyDescription herschelBulkley(double yield_stress, double consistency, double index, double regularisation) {
  RheologyDescription r;
  r.law = RheologyDescription::Law::kHerschelBulkley;
  r.yield_stress = yield_stress;
  r.consistency = consistency;
  r.index = index;
  r.regularisation = regularisation;
  r.minimum_viscosity = 1e-4;
  r.maximum_viscosity = consistency + regularisation * yield_stress;
  return r;
}

std::vector<Channel> channels() {
  std::vector<Channel> out;
  out.push_back({"Newtonian", {}, 2.0, [](double s) { return s / 2.0; }});
  for (const double n : {0.5, 1.5}) {
    const double K = n < 1.0 ? 10.0 : 0.5;
    out.push_back({n < 1.0 ? "power law, n 0.5" : "power law, n 1.5", powerLaw(K, n), 0.0,
                   [K, n](double s) { return std::pow(s / K, 1.0 / n); }});
  }
  RheologyDescription carreau;
  carreau.law = RheologyDescription::Law::kCarreauYasuda;
  carreau.zero_shear_viscosity = 10.0;
  carreau.infinite_shear_viscosity = 0.1;
  carreau.time_constant = 1.0;
  carreau.index = 0.4;
  out.push_back({"Carreau, n 0.4", carreau, 0.0,
                 inverted([](double rate) { return 0.1 + 9.9 * std::pow(1.0 + rate * rate, 0.5 * (0.4 - 1.0)); })});
  out.push_back({"Herschel-Bulkley, m 20, n 0.6", herschelBulkley(15.0, 8.0, 0.6, 20.0), 0.0, inverted([](double rate) {
                   const double eta = 8.0 * std::pow(rate, -0.4) + 15.0 * (1.0 - std::exp(-20.0 * rate)) / rate;
                   return std::min(eta, 8.0 + 20.0 * 15.0);
                 })});
  out.push_back({"Bingham plug, m 1000", herschelBulkley(20.0, 2.0, 1.0, 1000.0), 0.0,
                 [](double s) { return std::max(s - 20.0, 0.0) / 2.0; }});
  return out;
}

Scene channelScene(const Channel& channel, const Numerics& numerics) {
  const double h = kWidth / std::round(numerics.cells_across);
  Scene scene;
  scene.name = "channel";
  scene.tank.cell_width = h;
  scene.tank.size = {4.0 * h, 4.0 * h, kWidth};
  scene.tank.periodic[0] = scene.tank.periodic[1] = true;
  scene.liquid.density = kDensity;
  scene.liquid.dynamic_viscosity = channel.viscosity;
  scene.liquid.rheology = channel.rheology;
  scene.liquid.fill_level = kWidth;
  scene.gravity = {kGravity, 0.0, 0.0};
  scene.time_step = 1000.0;  // a step is steady at once
  scene.solver.cfl = 1e12;   // what moves along itself need not be followed
  apply(numerics, scene);
  return scene;
}

// Exact velocities at the centres of the lower half's cells by the midpoint rule from the wall: u' = rate(stress).
// Returns the mean.
double exactProfile(const Channel& channel, int cells, std::vector<double>& velocities) {
  const int each = kPoints / cells;  // points in half a cell
  const double dy = 0.5 * kWidth / cells / each;
  double u = 0.0, flow = 0.0, y = 0.0;
  for (int i = 0; i < cells; ++i) {
    for (int p = 0; p < each; ++p, y += dy) {
      const double gained = dy * channel.rate_of_stress(kWallStress * (1.0 - (y + 0.5 * dy) / (0.5 * kWidth)));
      flow += dy * (u + 0.5 * gained);
      u += gained;
    }
    if (i % 2 == 0) velocities.push_back(u);
  }
  return flow / (0.5 * kWidth);
}

std::vector<Measurement> run(const Channel& channel, const Numerics& numerics, Meter& meter) {
  const Scene scene = channelScene(channel, numerics);
  const int cells = static_cast<int>(std::lround(kWidth / scene.tank.cell_width));
  std::vector<double> exact;
  const double exact_mean = exactProfile(channel, cells, exact);
  Simulation simulation(scene);
  double mean = 0.0;
  int steps = 0;
  for (double change = 1.0; change > 1e-5 && steps < 10; ++steps) {
    const StepReport r = meter.step(simulation);
    const double before = mean;
    mean = r.liquid_momentum[0] / (kDensity * scene.tank.size.prod());
    change = std::abs(mean - before) / std::abs(mean);
  }
  const double h = scene.tank.cell_width;
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Eigen::Vector3d at = scene.tank.origin + Eigen::Vector3d(h, 0.5 * h, (static_cast<double>(i) + 0.5) * h);
    error += std::pow(simulation.liquidVelocity(at)[0] - exact[i], 2);
    size += exact[i] * exact[i];
  }
  const double goal = cells >= 32 ? 0.02 : cells >= 16 ? 0.04 : 0.0;
  return {{"mean velocity, m/s", mean, exact_mean, goal},
          {"rms error of the profile, of its rms", std::sqrt(error / size), 0.0, goal, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const Channel& channel : channels()) {
    const bool newtonian = channel.viscosity > 0.0;
    if (extent == Extent::kQuick && !newtonian && channel.name != "power law, n 0.5") continue;
    Sweep sweep;
    sweep.base.cells_across = 32.0;
    sweep.base.tolerance = 1e-6;
    sweep.cells = extent == Extent::kQuick ? std::vector<double>{16, 32} : std::vector<double>{8, 16, 32, 64};
    addSweep(
        channel.name, sweep,
        [channel](const Numerics& numerics, Meter& meter) { return run(channel, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case channelFlow() {
  Case c;
  c.name = "channel";
  c.title = "plane Poiseuille flow of Newtonian, power-law, Carreau and Herschel-Bulkley liquids";
  c.reference = "analytic, by quadrature of the law";
  c.across = "width";
  c.steady = true;
  c.variants = variants;
  c.orders = {{"Newtonian", "mean velocity, m/s", false, 1.8}};
  return c;
}

}  // namespace monolith
