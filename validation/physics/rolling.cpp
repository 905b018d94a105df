// A sphere on a dry incline: it rolls with 5/7 of g sin(t) where friction suffices and slides where it does not; thrown
// without spin along a level floor it slides until it rolls at 5/7 of its speed.

#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kRadius = 0.05;
constexpr double kGravity = 9.81;

Scene dryFloor(double angle, double friction, const Numerics& numerics) {
  Scene scene;
  scene.name = "rolling";
  scene.tank.size = {3.0, 0.4, 0.3};
  scene.tank.cell_width = 0.1;
  scene.liquid.fill_level = 0.0;
  scene.gravity = kGravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  scene.contact.friction = friction;
  scene.time_step = 0.01;
  scene.bodies.push_back(sphereBody("sphere", kRadius, 2000.0, {0.2, 0.2, kRadius}));
  apply(numerics, scene);
  return scene;
}

// Friction over its least for rolling, (2/7) tan(angle).
std::vector<Measurement> incline(double sufficiency, const Numerics& numerics, Meter& meter) {
  const double angle = 20.0 * M_PI / 180.0;
  const double friction = sufficiency * 2.0 / 7.0 * std::tan(angle);
  Simulation simulation(dryFloor(angle, friction, numerics));
  const double seconds = 0.5;
  meter.advance(simulation, seconds);
  const BodyState state = simulation.bodyStates()[0];
  const bool rolls = sufficiency >= 1.0;
  const double a =
      rolls ? 5.0 / 7.0 * kGravity * std::sin(angle) : kGravity * (std::sin(angle) - friction * std::cos(angle));
  const double spin = rolls ? a / kRadius : 2.5 * friction * kGravity * std::cos(angle) / kRadius;
  return {{"acceleration, m/s^2", state.velocity[0] / seconds, a, 1e-3},
          {"angular acceleration, rad/s^2", state.angular_velocity[1] / seconds, spin, 1e-3}};
}

std::vector<Measurement> thrown(const Numerics& numerics, Meter& meter) {
  const double speed = 1.0, friction = 0.2;
  Scene scene = dryFloor(0.0, friction, numerics);
  scene.bodies[0].velocity = {speed, 0.0, 0.0};
  Simulation simulation(scene);
  double rolling_since = 0.0;
  meter.advance(simulation, 0.5, [&](const StepReport& r) {
    const BodyState state = simulation.bodyStates()[0];
    if (std::abs(state.velocity[0] - kRadius * state.angular_velocity[1]) > 1e-6) rolling_since = r.time;
  });
  return {{"speed when it rolls, m/s", simulation.bodyStates()[0].velocity[0], 5.0 / 7.0 * speed, 1e-3},
          {"time until it rolls, s", rolling_since, 2.0 * speed / (7.0 * friction * kGravity), 0.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  Sweep sweep;
  sweep.base.cells_across = 1.0;
  sweep.base.dt = 0.01;
  if (extent == Extent::kFull) sweep.steps = {0.02, 0.005};
  for (const double sufficiency : {1.1, 0.9}) {
    addSweep(
        sufficiency > 1.0 ? "incline, enough friction to roll" : "incline, too little friction to roll", sweep,
        [=](const Numerics& n, Meter& meter) { return incline(sufficiency, n, meter); }, out);
  }
  addSweep("thrown without spin", sweep, thrown, out);
  return out;
}

}  // namespace

Case rolling() {
  Case c;
  c.name = "rolling";
  c.title = "a sphere that rolls or slides down a dry incline, or is thrown along the floor";
  c.reference = "rigid-body mechanics: rolls iff friction >= (2/7) tan(angle)";
  c.across = "diameter (no liquid: without meaning)";
  c.variants = variants;
  return c;
}

}  // namespace monolith
