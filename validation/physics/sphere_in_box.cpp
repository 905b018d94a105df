// Drag and torque of a sphere that moves or turns at the centre of a closed cubic box, creeping.

#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

// By the method of fundamental solutions, to 1e-4 (drag) and 1e-4 (torque): radius over half side, F/(6 pi mu a U),
// T/(8 pi mu a^3 W).
struct Row {
  double ratio, drag, torque;
};
constexpr Row kRows[] = {{0.2, 1.6017, 1.0057}, {0.3, 2.175, 1.01949}, {0.4, 3.1235, 1.0475}, {0.5, 4.7846, 1.0973}};

std::vector<Measurement> run(const Row& row, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across / row.ratio);
  meter.setCellsAcross(row.ratio * cells);
  const double radius = 0.5 * row.ratio;
  const Scene empty = creepingScene(Eigen::Vector3d::Ones(), 1.0 / cells, numerics);
  const Eigen::Vector3d speed(0.0, 0.0, 1.0);
  const auto wrench = [&](const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity) {
    Scene scene = empty;
    scene.bodies.push_back(sphereBody("sphere", radius, 1.0, Eigen::Vector3d::Constant(0.5)));
    moveInPlace(scene.bodies[0], velocity, angular_velocity);
    Simulation simulation(scene);
    steadyValue(simulation, meter, [&](const StepReport&) {
      const Wrench w = simulation.bodyStates()[0].liquid;
      return w.force[2] + w.torque[2];
    });
    return simulation.bodyStates()[0].liquid;
  };
  const double drag = -wrench(speed, Eigen::Vector3d::Zero()).force[2] / (6.0 * M_PI * radius);
  const double torque = -wrench(Eigen::Vector3d::Zero(), speed).torque[2] / (8.0 * M_PI * std::pow(radius, 3));
  const double goal = dragGoal(row.ratio * cells);
  return {{"drag factor", drag, row.drag, goal}, {"torque factor", torque, row.torque, goal}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const Row& row : kRows) {
    if (extent == Extent::kQuick && row.ratio != 0.4) continue;
    Sweep sweep;
    sweep.base.cells_across = 10.0;
    sweep.cells = extent == Extent::kQuick ? std::vector<double>{4, 10} : std::vector<double>{4, 6, 8, 10, 16};
    if (extent == Extent::kFull && row.ratio == 0.4) {
      sweep.tolerances = {1e-2, 1e-3, 1e-4, 1e-6};
      sweep.fractions = true;
    }
    char name[64];
    std::snprintf(name, sizeof name, "diameter %g of the side", row.ratio);
    addSweep(
        name, sweep, [&row](const Numerics& numerics, Meter& meter) { return run(row, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case sphereInBox() {
  Case c;
  c.name = "box";
  c.title = "Stokes drag and torque of a sphere in a closed cubic box";
  c.reference = "method of fundamental solutions, 1e-4";
  c.across = "diameter";
  c.steady = true;
  c.variants = variants;
  return c;
}

}  // namespace monolith
