// A slender column of very viscous liquid that stands on the floor gives way under its weight by folding, as honey
// does; one of thin liquid, with the same small kinks, slumps without. Folding needs the full stress at the free
// surface, solved together with pressure (Larionov, Batty & Bridson 2017, ACM Trans. Graph. 36, 101): only seen in
// kind.

#include <cmath>
#include <map>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kWidth = 0.0125, kHeight = 0.1;  // m

Scene columnScene(double viscosity, double dt, const Numerics& numerics) {
  const double h = kWidth / std::round(numerics.cells_across);
  const double side = 2.0 * std::round(2.4 * kWidth / h);
  Scene scene;
  scene.source = "rope";
  scene.tank.cell_width = h;
  scene.tank.size = h * Eigen::Vector3d(side, side, std::ceil(1.1 * kHeight / h) + 2.0);
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = dt;
  // Kinks of a tenth of the width.
  constexpr int kPieces = 8;
  for (int i = 0; i < kPieces; ++i) {
    const double phase = M_PI * (i + 0.5) / kPieces;
    const Eigen::Vector3d low(0.5 * side * h + kWidth * (0.1 * std::sin(3.0 * phase) - 0.5),
                              0.5 * side * h + kWidth * (0.1 * std::cos(5.0 * phase) - 0.5), kHeight * i / kPieces);
    scene.liquid.boxes.emplace_back(low, low + Eigen::Vector3d(kWidth, kWidth, kHeight / kPieces));
  }
  apply(numerics, scene);
  return scene;
}

struct Column {
  double height = 0.0;  // m
  double lean = 0.0;  // how far the axis leaves the vertical, in widths: of slices of two cells, but those at the ends
};

Column columnOf(const Simulation& simulation) {
  const TankDescription& tank = simulation.scene().tank;
  const double slice = 2.0 * tank.cell_width;
  Column out;
  std::map<int, Eigen::Vector3d> slices;
  for (const SurfacePoint& p : simulation.surfacePoints()) {
    slices.try_emplace(static_cast<int>(p.position[2] / slice), Eigen::Vector3d::Zero())
        .first->second += Eigen::Vector3d(p.position[0], p.position[1], 1.0);
  }
  if (slices.empty()) return out;
  out.height = (slices.rbegin()->first + 1) * slice;
  for (const auto& [level, sum] : slices) {
    const double z = (level + 0.5) * slice;
    if (z < kWidth || z > out.height - kWidth) continue;
    out.lean = std::max(out.lean, (sum.head<2>() / sum[2] - 0.5 * tank.size.head<2>()).norm() / kWidth);
  }
  return out;
}

std::vector<Measurement> run(bool viscous, const Numerics& numerics, Meter& meter) {
  const Scene scene = columnScene(viscous ? 50.0 : 0.05, viscous ? 0.005 : 0.002, numerics);
  Simulation simulation(scene);
  double most = 0.0;
  // What is lower is a heap.
  for (Column column = columnOf(simulation); column.height > 0.6 * kHeight; column = columnOf(simulation)) {
    most = std::max(most, column.lean);
    meter.step(simulation);
  }
  // Half a width: the axis leaves what the column stood on.
  const bool folds = most > 0.5;
  return {observed(viscous ? "it folds: the axis leaves the vertical by half a width" : "it does not fold",
                   folds == viscous),
          {"farthest that the axis is off the vertical, in widths", most, 0.0, 0.0, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  Sweep sweep;
  sweep.base.cells_across = 5.0;
  if (extent == Extent::kFull) sweep.cells = {5, 8};
  for (const bool viscous : {true, false}) {
    if (extent == Extent::kQuick && !viscous) continue;
    addSweep(
        viscous ? "viscosity 50 Pa s" : "viscosity 0.05 Pa s", sweep,
        [viscous](const Numerics& numerics, Meter& meter) { return run(viscous, numerics, meter); }, out);
  }
  return out;
}

}  // namespace

Case viscousRope() {
  Case c;
  c.name = "rope";
  c.title = "a slender column of viscous liquid folds, one of thin liquid does not";
  c.reference = "in kind: Larionov, Batty & Bridson 2017, ACM Trans. Graph. 36, 101";
  c.across = "width";
  c.variants = variants;
  return c;
}

}  // namespace monolith
