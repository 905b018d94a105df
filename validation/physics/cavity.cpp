// Flow in a square cavity under a moving lid, plane (periodic along y): profiles of Ghia, Ghia & Shin 1982, J. Comput.
// Phys. 48, 387, tables I and II, right to about 1 % of the lid's speed. Their v(0.9063) at Re 400 is a misprint and
// left out.

#include <algorithm>
#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

struct Profile {
  double at;
  double value[3];  // Re 100, 400, 1000
};
// u over the height, at the middle of the width.
constexpr Profile kU[] = {{0.9766, {0.84123, 0.75837, 0.65928}},   {0.9688, {0.78871, 0.68439, 0.57492}},
                          {0.9609, {0.73722, 0.61756, 0.51117}},   {0.9531, {0.68717, 0.55892, 0.46604}},
                          {0.8516, {0.23151, 0.29093, 0.33304}},   {0.7344, {0.00332, 0.16256, 0.18719}},
                          {0.6172, {-0.13641, 0.02135, 0.05702}},  {0.5, {-0.20581, -0.11477, -0.0608}},
                          {0.4531, {-0.2109, -0.17119, -0.10648}}, {0.2813, {-0.15662, -0.32726, -0.27805}},
                          {0.1719, {-0.1015, -0.24299, -0.38289}}, {0.1016, {-0.06434, -0.14612, -0.2973}},
                          {0.0703, {-0.04775, -0.10338, -0.2222}}, {0.0625, {-0.04192, -0.09266, -0.20196}},
                          {0.0547, {-0.03717, -0.08186, -0.18109}}};
// v over the width, at the middle of the height.
constexpr Profile kV[] = {{0.9688, {-0.05906, -0.12146, -0.21388}}, {0.9609, {-0.07391, -0.15663, -0.27669}},
                          {0.9531, {-0.08864, -0.19254, -0.33714}}, {0.9453, {-0.10313, -0.22847, -0.39188}},
                          {0.8594, {-0.22445, -0.44993, -0.42665}}, {0.8047, {-0.24533, -0.38598, -0.31966}},
                          {0.5, {0.05454, 0.05186, 0.02526}},       {0.2344, {0.17527, 0.30174, 0.32235}},
                          {0.2266, {0.17507, 0.30203, 0.33075}},    {0.1563, {0.16077, 0.28124, 0.37095}},
                          {0.0938, {0.12317, 0.22965, 0.32627}},    {0.0781, {0.1089, 0.2092, 0.30353}},
                          {0.0703, {0.10091, 0.19713, 0.29012}},    {0.0625, {0.09233, 0.1836, 0.27485}}};

constexpr double kReynolds[] = {100.0, 400.0, 1000.0};
constexpr double kTimes[] = {15.0, 40.0, 60.0};  // of the lid across the cavity, until the flow is steady

std::vector<Measurement> run(int which, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across);
  const double h = 1.0 / cells;
  Scene scene = creepingScene({1.0, 4.0 * h, 1.0 + 2.0 * h}, h, numerics);
  scene.tank.periodic[1] = true;
  scene.liquid.dynamic_viscosity = 1.0 / kReynolds[which];
  scene.time_step = numerics.dt;
  scene.solver.cfl = SolverDescription().cfl;  // as users have it
  scene.bodies.push_back(boxBody("lid", {1.0, 40.0 * h, 2.0 * h}, 1.0, {0.5, 2.0 * h, 1.0 + h}));
  moveInPlace(scene.bodies[0], Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  Simulation simulation(scene);
  meter.advance(simulation, kTimes[which]);
  double worst = 0.0, sum = 0.0;
  int points = 0;
  const auto compare = [&](double error) {
    worst = std::max(worst, std::abs(error));
    sum += error * error;
    ++points;
  };
  for (const Profile& p : kU) compare(simulation.liquidVelocity({0.5, 2.0 * h, p.at})[0] - p.value[which]);
  for (const Profile& p : kV) compare(simulation.liquidVelocity({p.at, 2.0 * h, 0.5})[2] - p.value[which]);
  double least_u = 0.0, published = 0.0;
  for (int i = 1; i < 400; ++i) least_u = std::min(least_u, simulation.liquidVelocity({0.5, 2.0 * h, i / 400.0})[0]);
  for (const Profile& p : kU) published = std::min(published, p.value[which]);
  const double goal = cells >= 64.0 ? 0.02 : 0.0;
  return {{"rms deviation, of the lid's speed", std::sqrt(sum / points), 0.0, goal, 1.0},
          {"largest deviation, of the lid's speed", worst, 0.0, 0.0, 1.0},
          {"least u on the vertical", least_u, published, 0.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (int which = 0; which < 3; ++which) {
    if (!full && which > 0) continue;
    Sweep sweep;
    sweep.base.cells_across = full ? 64.0 : 32.0;
    sweep.base.dt = full ? 1.0 / 64.0 : 1.0 / 16.0;
    sweep.cells = full ? std::vector<double>{16, 32, 64} : std::vector<double>{16, 32};
    if (full) sweep.steps = {1.0 / 16.0, 1.0 / 32.0, 1.0 / 128.0};
    char name[32];
    std::snprintf(name, sizeof name, "Re %g", kReynolds[which]);
    addSweep(
        name, sweep, [which](const Numerics& n, Meter& meter) { return run(which, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case lidDrivenCavity() {
  Case c;
  c.name = "cavity";
  c.title = "plane flow in a square cavity under a moving lid, Re 100, 400, 1000";
  c.reference = "Ghia, Ghia & Shin 1982, J. Comput. Phys. 48, 387 (scatter about 1 %)";
  c.across = "side";
  c.variants = variants;
  return c;
}

}  // namespace monolith
