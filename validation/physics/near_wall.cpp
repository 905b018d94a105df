// Stokes drag of a sphere that moves straight towards a wall: Brenner 1961, Chem. Eng. Sci. 16, 242. The other walls of
// the tank are far off, and the flow between sphere and wall decays fast: at this distance they change the drag by less
// than 0.1 %.

#include <cmath>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

constexpr double kTank = 16.0;  // radii

// Height of the centre over the radius, F/(6 pi mu a U) by Brenner's series.
struct Row {
  double height, drag;
};
constexpr Row kRows[] = {{2.3524, 1.837481}, {1.5431, 3.035994}, {1.2, 6.340887}, {1.1, 11.459157}};

std::vector<Measurement> run(const Row& row, const Numerics& numerics, Meter& meter) {
  // The sphere has radius 1/kTank.
  const double cells = 2.0 * std::round(0.25 * numerics.cells_across * kTank);
  const double radius = 1.0 / kTank;
  meter.setCellsAcross(2.0 * radius * cells);
  Scene scene = creepingScene(Eigen::Vector3d::Ones(), 1.0 / cells, numerics);
  scene.bodies.push_back(sphereBody("sphere", radius, 1.0, {0.5, 0.5, row.height * radius}));
  moveInPlace(scene.bodies[0], {0.0, 0.0, -1.0}, Eigen::Vector3d::Zero());
  Simulation simulation(scene);
  const double force =
      steadyValue(simulation, meter, [&](const StepReport&) { return simulation.bodyStates()[0].liquid.force[2]; });
  // The goals of drag, where at least a cell is between sphere and wall.
  const double gap = (row.height - 1.0) * radius * cells;
  return {{"drag factor", force / (6.0 * M_PI * radius), row.drag, gap >= 1.0 ? dragGoal(2.0 * radius * cells) : 0.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const Row& row : kRows) {
    if (extent == Extent::kQuick && row.height != 1.5431) continue;
    Sweep sweep;
    sweep.base.cells_across = 8.0;
    sweep.cells = extent == Extent::kQuick ? std::vector<double>{4} : std::vector<double>{4, 6, 8, 10};
    char name[64];
    std::snprintf(name, sizeof name, "gap of %g radii", row.height - 1.0);
    addSweep(
        name, sweep, [&row](const Numerics& numerics, Meter& meter) { return run(row, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case nearWall() {
  Case c;
  c.name = "wall";
  c.title = "Stokes drag of a sphere that moves towards a wall";
  c.reference = "Brenner 1961, Chem. Eng. Sci. 16, 242";
  c.across = "diameter";
  c.steady = true;
  c.variants = variants;
  return c;
}

}  // namespace monolith
