// Drafting, kissing, tumbling: of two equal spheres that settle one above the other, the rear one is drawn along,
// catches up, touches the front one, and both turn side by side (Fortes, Joseph & Lundgren 1987, J. Fluid Mech. 177,
// 467). Set-up after Glowinski et al. 2001, J. Comput. Phys. 169, 363; only the phases are compared, the motion after
// contact depends on the smallest disturbance.

#include <algorithm>
#include <cmath>

#include "framework/meter.h"
#include "framework/scene_parts.h"

namespace monolith {
namespace {

constexpr double kDiameter = 0.01 / 6.0;

std::vector<Measurement> run(double density, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across * 0.01 / kDiameter);
  const double h = 0.01 / cells;
  meter.setCellsAcross(kDiameter / h);
  Scene scene;
  scene.name = "two spheres";
  scene.tank.size = {0.01, 0.01, 0.04};
  scene.tank.cell_width = h;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 1e-3;
  scene.liquid.fill_level = 0.04;
  apply(numerics, scene);
  const Eigen::Vector3d middle(0.005, 0.005, 0.0);
  const double radius = 0.5 * kDiameter;
  scene.bodies.push_back(sphereBody("front", radius, density, middle + Eigen::Vector3d(0.0, 0.0, 0.0316)));
  // Off the axis by a tenth of the diameter: the pair has to fall to some side.
  scene.bodies.push_back(sphereBody("rear", radius, density, middle + Eigen::Vector3d(0.1 * kDiameter, 0.0, 0.035)));
  Simulation simulation(scene);
  bool drafted = false, kissed = false, tumbled = false;
  double closest = 1.0, fastest = 0.0;
  meter.advance(simulation, 0.8, [&](const StepReport&) {
    const std::vector<BodyState> bodies = simulation.bodyStates();
    const Eigen::Vector3d apart = bodies[1].X_WB.translation() - bodies[0].X_WB.translation();
    const double gap = apart.norm() - kDiameter;
    const bool falling = bodies[0].X_WB.translation()[2] > 2.0 * kDiameter;
    closest = std::min(closest, gap / h);
    fastest = std::max(fastest, -bodies[0].velocity[2]);
    drafted = drafted || (falling && -bodies[1].velocity[2] > -1.05 * bodies[0].velocity[2] && gap > 0.1 * kDiameter);
    kissed = kissed || (drafted && falling && gap < 0.1 * h);
    tumbled = tumbled || (kissed && falling && apart.head<2>().norm() > std::abs(apart[2]));
  });
  return {observed("drafting: the rear one gains", drafted),
          observed("kissing: they touch", kissed),
          observed("tumbling: they turn side by side", tumbled),
          {"deepest overlap, of a cell", std::min(closest, 0.0), 0.0, 0.05, 1.0},
          {"Reynolds number of the front one", fastest * kDiameter / 1e-6, 0.0, 0.0, 1.0}};
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  if (extent == Extent::kQuick) return out;
  Sweep sweep;
  sweep.base.cells_across = 4.0;
  sweep.base.dt = 0.005;
  sweep.cells = {4, 6};
  addSweep(
      "density 1.14", sweep, [](const Numerics& numerics, Meter& meter) { return run(1140.0, numerics, meter); }, out);
  return out;
}

}  // namespace

Case twoSpheres() {
  Case c;
  c.name = "tumbling";
  c.title = "two settling spheres draft, kiss and tumble";
  c.reference = "Fortes, Joseph & Lundgren 1987, J. Fluid Mech. 177, 467 (phases only)";
  c.across = "diameter";
  c.variants = variants;
  return c;
}

}  // namespace monolith
