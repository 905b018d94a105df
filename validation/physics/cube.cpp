// Stokes drag and torque of a cube of edge s at the centre of a closed cubic box of 7 s. Without walls F = 12.72 mu s U
// and T = 8 pi mu W 0.3206 s^3. The walls act on it as on a sphere of the same F, T: 1/(1 - 1.943 l + 1.66 l^3 - 0.81
// l^5) for the drag, 1 + 0.0057 (l/0.2)^3 for the torque, l that sphere's radius over half the box's side; right to
// about 0.2 %.

#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

constexpr double kTank = 7.0;  // edges
constexpr double kDrag = 12.72;
constexpr double kTorque = 8.0 * M_PI * 0.3206;

double confinedDrag(double edge) {
  const double l = 2.0 * edge * kDrag / (6.0 * M_PI);
  return kDrag * edge / (1.0 - 1.943 * l + 1.66 * std::pow(l, 3) - 0.81 * std::pow(l, 5));
}

double confinedTorque(double edge) {
  const double l = 2.0 * edge * std::cbrt(kTorque / (8.0 * M_PI));
  return kTorque * std::pow(edge, 3) * (1.0 + 0.0057 * std::pow(l / 0.2, 3));
}

// A quarter of a turn about z brings the cube back; at 22.5 degrees it lies least along the grid.
std::vector<Measurement> run(double turned, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across * kTank);
  const double edge = 1.0 / kTank;
  meter.setCellsAcross(cells * edge);
  const Scene empty = creepingScene(Eigen::Vector3d::Ones(), 1.0 / cells, numerics);
  const auto wrench = [&](const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity) {
    Scene scene = empty;
    scene.bodies.push_back(boxBody("cube", Eigen::Vector3d::Constant(edge), 1.0, Eigen::Vector3d::Constant(0.5)));
    scene.bodies[0].X_WB.linear() = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    moveInPlace(scene.bodies[0], velocity, angular_velocity);
    Simulation simulation(scene);
    steadyValue(simulation, meter, [&](const StepReport&) {
      const Wrench w = simulation.bodyStates()[0].liquid;
      return w.force[0] + w.torque[2];
    });
    return simulation.bodyStates()[0].liquid;
  };
  const double drag = -wrench(Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()).force[0];
  const double torque = -wrench(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()).torque[2];
  const double goal = dragGoal(cells * edge);
  return {{"drag", drag, confinedDrag(edge), goal}, {"torque", torque, confinedTorque(edge), goal}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const bool turned : {false, true}) {
    if (extent == Extent::kQuick) continue;
    Sweep sweep;
    sweep.base.cells_across = 6.0;
    sweep.cells = {4, 6, 8, 10};
    const double angle = turned ? M_PI / 8.0 : 0.0;
    addSweep(
        turned ? "turned by 22.5 degrees" : "along the grid", sweep,
        [angle](const Numerics& numerics, Meter& meter) { return run(angle, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case cube() {
  Case c;
  c.name = "cube";
  c.title = "Stokes drag and torque of a cube in a closed box";
  c.reference = "resistance of a cube without walls, computed; walls by reflection";
  c.across = "edge";
  c.steady = true;
  c.variants = variants;
  return c;
}

}  // namespace monolith
