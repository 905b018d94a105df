#include "physics/creeping.h"

#include <cmath>

#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kViscousNumber = 500.0;  // nu dt/h^2
constexpr double kSteady = 1e-6;
constexpr int kMostSteps = 200;

}  // namespace

double dragGoal(double cells_across) { return cells_across >= 10.0 ? 0.005 : cells_across >= 4.0 ? 0.02 : 0.0; }

Scene creepingScene(const Eigen::Vector3d& size, double cell_width, const Numerics& numerics) {
  Scene scene;
  scene.name = "creeping";
  scene.tank.size = size;
  scene.tank.cell_width = cell_width;
  scene.liquid.density = 1.0;
  scene.liquid.dynamic_viscosity = 1.0;
  scene.liquid.fill_level = size[2];
  scene.gravity.setZero();
  scene.time_step = kViscousNumber * cell_width * cell_width;
  scene.solver.cfl = 1e12;  // nothing that moves need be followed
  apply(numerics, scene);
  return scene;
}

void moveInPlace(BodyDescription& body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity) {
  body.motion = BodyMotion::kPrescribed;
  body.prescribed.in_place = true;
  body.prescribed.twist << velocity, angular_velocity;
}

double steadyValue(Simulation& simulation, Meter& meter, const std::function<double(const StepReport&)>& value) {
  double last = value(meter.step(simulation));
  for (int step = 1; step < kMostSteps; ++step) {
    const double next = value(meter.step(simulation));
    const double change = std::abs(next - last);
    last = next;
    if (change <= kSteady * std::abs(next)) break;
  }
  return last;
}

}  // namespace monolith
