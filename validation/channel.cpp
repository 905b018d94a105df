#include <cmath>
#include <cstdio>
#include <functional>

#include "cases.h"
#include "simulation/simulation.h"

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
  double viscosity = 0.0;                       // of a Newtonian liquid
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
  out.push_back({"Carreau, n 0.4", carreau, 0.0, inverted([](double rate) {
                   return 0.1 + 9.9 * std::pow(1.0 + rate * rate, 0.5 * (0.4 - 1.0));
                 })});
  out.push_back({"Herschel-Bulkley, m 20, n 0.6", herschelBulkley(15.0, 8.0, 0.6, 20.0), 0.0, inverted([](double rate) {
                   const double eta = 8.0 * std::pow(rate, -0.4) + 15.0 * (1.0 - std::exp(-20.0 * rate)) / rate;
                   return std::min(eta, 8.0 + 20.0 * 15.0);
                 })});
  out.push_back({"Bingham plug, m 1000", herschelBulkley(20.0, 2.0, 1.0, 1000.0), 0.0,
                 [](double s) { return std::max(s - 20.0, 0.0) / 2.0; }});
  return out;
}

Scene channelScene(const Channel& channel, int cells) {
  const double h = kWidth / cells;
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
  scene.time_step = 1000.0;   // a step is steady at once
  scene.solver.cfl = 1e12;    // what moves along itself need not be followed
  scene.solver.tolerance = 1e-6;
  return scene;
}

bool runOne(const Channel& channel, int cells, double goal) {
  // Exact velocity at the centres of the cells by the midpoint rule from the wall: u' = rate(stress).
  const int half = cells / 2;
  const int each = kPoints / cells;  // points in half a cell
  const double dy = 0.5 * kWidth / cells / each;
  std::vector<double> exact;
  double u = 0.0, flow = 0.0, y = 0.0;
  for (int i = 0; i < 2 * half; ++i) {
    for (int p = 0; p < each; ++p, y += dy) {
      const double gained = dy * channel.rate_of_stress(kWallStress * (1.0 - (y + 0.5 * dy) / (0.5 * kWidth)));
      flow += dy * (u + 0.5 * gained);
      u += gained;
    }
    if (i % 2 == 0) exact.push_back(u);
  }
  const double exact_mean = flow / (0.5 * kWidth);

  const Scene scene = channelScene(channel, cells);
  Simulation simulation(scene);
  int iterations = 0, linear = 0, steps = 0;
  double mean = 0.0, seconds = 0.0;
  for (double change = 1.0; change > 1e-5 && steps < 10; ++steps) {
    const StepReport r = simulation.step();
    if (!r.committed()) {
      std::printf("%s, %d cells: %s\n", channel.name.c_str(), cells, r.message.c_str());
      return false;
    }
    iterations += r.rheology_iterations;
    linear += r.iterations;
    seconds += r.times.total;
    const double before = mean;
    mean = r.liquid_momentum[0] / (kDensity * scene.tank.size.prod());
    change = std::abs(mean - before) / std::abs(mean);
  }
  const double h = scene.tank.cell_width;
  double error = 0.0, size = 0.0;
  for (int i = 0; i < half; ++i) {
    const double found = simulation.liquidVelocity(scene.tank.origin + Eigen::Vector3d(h, 0.5 * h, (i + 0.5) * h))[0];
    error += std::pow(found - exact[i], 2);
    size += exact[i] * exact[i];
  }
  const double profile = std::sqrt(error / size);
  std::printf("%s, %d cells: %d steps, %d viscosity and %d linear iterations, %.2f s\n", channel.name.c_str(), cells,
              steps, iterations, linear, seconds);
  const bool flow_met = report(channel.name + ", " + std::to_string(cells), "mean velocity m/s", mean, exact_mean, goal);
  const bool profile_met =
      report(channel.name + ", " + std::to_string(cells), "1 + profile's error", 1.0 + profile, 1.0, goal);
  return flow_met && profile_met;
}

}  // namespace

bool runChannel() {
  bool met = true;
  for (const Channel& channel : channels()) {
    met = runOne(channel, 16, 0.04) && met;
    met = runOne(channel, 32, 0.02) && met;
  }
  return met;
}

}  // namespace monolith
