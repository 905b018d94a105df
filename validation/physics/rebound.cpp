// A steel ball falls on the floor in silicone oil: the liquid takes from the rebound what dry restitution would give,
// all of it below a Stokes number of about ten.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kDiameter = 0.006;
constexpr double kBall = 7800.0, kOil = 935.0;
constexpr double kSpeed = 0.5;              // m/s, at the start; St = rho_s U D/(9 mu)
constexpr double kRestitution = 0.97;       // dry, steel on glass
constexpr double kStart = 0.5 * kDiameter;  // gap

// Largest speed of rebound over the speed of approach a quarter of a diameter from the floor, over the dry restitution.
double rebound(double stokes, const Numerics& numerics, Meter& meter) {
  Scene scene;
  scene.name = "rebound";
  const double h = kDiameter / std::round(numerics.cells_across);
  scene.tank.cell_width = h;
  scene.tank.size = h * Eigen::Vector3d::Constant(std::round(3.0 * kDiameter / h));
  scene.liquid.density = kOil;
  scene.liquid.dynamic_viscosity = kBall * kSpeed * kDiameter / (9.0 * stokes);
  scene.liquid.fill_level = scene.tank.size[2];
  scene.contact.restitution = kRestitution;
  scene.time_step = 2.5e-4;
  scene.gravity.setZero();
  scene.bodies.push_back(sphereBody("ball", 0.5 * kDiameter, kBall,
                                    {0.5 * scene.tank.size[0], 0.5 * scene.tank.size[1], kStart + 0.5 * kDiameter}));
  scene.bodies[0].velocity = {0.0, 0.0, -kSpeed};
  apply(numerics, scene);
  Simulation simulation(scene);
  double approach = kSpeed, up = 0.0;
  meter.advance(simulation, 0.04, [&](const StepReport&) {
    const BodyState ball = simulation.bodyStates()[0];
    const double gap = ball.X_WB.translation()[2] - 0.5 * kDiameter;
    if (ball.velocity[2] < 0.0 && up == 0.0 && gap > 0.25 * kDiameter) approach = -ball.velocity[2];
    up = std::max(up, ball.velocity[2]);
  });
  return up / approach / kRestitution;
}

std::vector<Measurement> run(const Numerics& numerics, Meter& meter) {
  std::vector<Measurement> out;
  double last = -1.0;
  bool grows = true;
  for (const double stokes : {3.0, 10.0, 40.0, 150.0, 600.0}) {
    const double restitution = rebound(stokes, numerics, meter);
    grows = grows && restitution >= last;
    last = restitution;
    char name[64];
    std::snprintf(name, sizeof(name), "restitution over the dry one, St %.0f", stokes);
    out.push_back({name, restitution, stokes < 10.0 ? 0.0 : std::exp(-35.0 / stokes), 0.0, 1.0});
  }
  out.push_back(observed("restitution grows with the Stokes number", grows));
  out.push_back(observed("none to speak of below St 10", out[0].result < 0.1));
  return out;
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  Sweep sweep;
  sweep.base.cells_across = 8.0;
  sweep.base.dt = 2.5e-4;
  if (extent == Extent::kFull) sweep.steps = {1e-3};
  if (extent == Extent::kFull) sweep.cells = {6.0, 8.0};
  addSweep("ball against the floor", sweep, run, out);
  return out;
}

}  // namespace

Case reboundInLiquid() {
  Case c;
  c.name = "rebound";
  c.title = "a ball's rebound from the floor in liquid against Stokes number, qualitatively";
  c.reference = "Gondret, Lance & Petit 2002, Phys. Fluids 14, 643; fit exp(-35/St)";
  c.across = "diameter";
  c.variants = variants;
  return c;
}

}  // namespace monolith
