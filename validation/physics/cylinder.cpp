// Plane Stokes flow about an endless cylinder along the periodic axis z: drag midway between two walls, and torque
// inside a fixed concentric ring (Taylor-Couette).

#include <cmath>
#include <memory>

#include "framework/scene_parts.h"
#include "physics/creeping.h"

namespace monolith {
namespace {

// Diameter over the channel's width, F/(4 pi mu U) per length: method of fundamental solutions; Faxen 1946 within 2e-5
// up to 0.2.
struct Row {
  double ratio, drag;
};
constexpr Row kRows[] = {{0.2, 1.315618}, {0.3, 2.320363}, {0.5, 7.907423}};
const char* const kDragFactor = "drag factor";
const char* const kInnerTorque = "torque of the inner cylinder";
const char* const kRingTorque = "torque of the ring";
constexpr int kLayers = 4;       // cells along z
constexpr double kAspect = 5.0;  // length of the channel over its width; the flow decays by e^-4 a width

std::vector<Measurement> drag(const Row& row, double offset_cells, const Numerics& numerics, Meter& meter) {
  const double cells = std::round(numerics.cells_across / row.ratio);
  const double h = 1.0 / cells;
  meter.setCellsAcross(row.ratio * cells);
  Scene scene = creepingScene({std::round(kAspect * cells) * h, 1.0, kLayers * h}, h, numerics);
  scene.tank.periodic[2] = true;
  const double depth = kLayers * h;
  const double middle = 0.5 * scene.tank.size[0] + offset_cells * h;
  scene.bodies.push_back(cylinderBody("cylinder", 0.5 * row.ratio, 10.0 * depth, 1.0, {middle, 0.5, 0.5 * depth}));
  moveInPlace(scene.bodies[0], Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  Simulation simulation(scene);
  const double force =
      steadyValue(simulation, meter, [&](const StepReport&) { return -simulation.bodyStates()[0].liquid.force[0]; });
  return {{kDragFactor, force / (4.0 * M_PI * depth), row.drag, dragGoal(row.ratio * cells)}};
}

// Between radius `inner` and the corners of a square of half side `outer`, along z.
std::shared_ptr<const TriangleMesh> ring(double inner, double outer, double length) {
  constexpr int kSides = 256;  // a multiple of 8; the circle's radius is right to 1e-4 of itself
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = "ring";
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * M_PI * i / kSides;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d in = inner * direction;
    const Eigen::Vector2d out = outer / direction.cwiseAbs().maxCoeff() * direction;
    for (const double z : {-0.5 * length, 0.5 * length}) {
      mesh->vertices.emplace_back(in[0], in[1], z);
      mesh->vertices.emplace_back(out[0], out[1], z);
    }
  }
  for (int i = 0; i < kSides; ++i) {
    const int a = 4 * i, b = 4 * ((i + 1) % kSides);  // +0: inner low, 1: outer low, 2: inner high, 3: outer high
    const auto quad = [&](int p, int q, int r, int s) {
      mesh->triangles.emplace_back(p, q, r);
      mesh->triangles.emplace_back(p, r, s);
    };
    quad(a + 1, b + 1, b + 3, a + 3);  // outside
    quad(b, a, a + 2, b + 2);          // inside
    quad(a, b, b + 1, a + 1);          // below
    quad(a + 2, a + 3, b + 3, b + 2);  // above
  }
  return mesh;
}

std::vector<Measurement> torque(double ratio, const Numerics& numerics, Meter& meter) {
  // Inner radius a, outer radius b in a tank of edge 1, the ring 0.1 thick at least.
  const double b = 0.4, a = ratio * b;
  const double cells = 2.0 * std::round(0.5 * numerics.cells_across / (2.0 * a));
  const double h = 1.0 / cells, depth = kLayers * h;
  meter.setCellsAcross(2.0 * a * cells);
  Scene scene = creepingScene({1.0, 1.0, depth}, h, numerics);
  scene.tank.periodic[2] = true;
  const Eigen::Vector3d middle(0.5, 0.5, 0.5 * depth);
  scene.bodies.push_back(cylinderBody("inner", a, 10.0 * depth, 1.0, middle));
  moveInPlace(scene.bodies[0], Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  BodyDescription outer = boxBody("outer", {1.0, 1.0, depth}, 1.0, middle);
  outer.shapes[0].kind = Shape::Kind::kMesh;
  outer.shapes[0].mesh = ring(b, 0.5, 4.0 * depth);
  moveInPlace(outer, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  scene.bodies.push_back(outer);
  Simulation simulation(scene);
  const auto inner_torque = [&](const StepReport&) { return -simulation.bodyStates()[0].liquid.torque[2]; };
  const double found = steadyValue(simulation, meter, inner_torque);
  const double expected = 4.0 * M_PI * a * a * b * b / (b * b - a * a) * depth;
  const double speed = simulation.liquidVelocity(middle + Eigen::Vector3d(0.5 * (a + b), 0.0, 0.0))[1];
  const double r = 0.5 * (a + b);
  const double goal = dragGoal(2.0 * a * cells);
  return {{kInnerTorque, found, expected, goal},
          {kRingTorque, simulation.bodyStates()[1].liquid.torque[2], expected, goal},
          {"speed midway", speed, a * a / (b * b - a * a) * (b * b / r - r), 0.0}};
}

std::vector<Variant> variants(Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const Row& row : kRows) {
    for (const double offset : {0.0, 0.3}) {
      if (!full && (row.ratio != 0.5 || offset > 0.0)) continue;
      Sweep sweep;
      sweep.base.cells_across = 10.0;
      sweep.cells = full ? std::vector<double>{4, 6, 8, 10, 16} : std::vector<double>{10};
      sweep.fractions = full && offset == 0.0;
      char name[64];
      std::snprintf(name, sizeof name, "drag, diameter %g of the width%s", row.ratio, offset > 0.0 ? ", shifted" : "");
      const RunFunction run = [&row, offset](const Numerics& n, Meter& meter) { return drag(row, offset, n, meter); };
      addSweep(name, sweep, run, out);
      if (full) continue;
      // Here the goals are missed.
      for (const auto& [cells, error] : {std::pair(4.0, 0.047), std::pair(16.0, 0.0097)}) {
        sweep.cells = {cells};
        addSweep(name, sweep, atMost(error, kDragFactor, run), out);
      }
    }
  }
  for (const double ratio : {0.25, 0.5, 0.8}) {
    if (!full && ratio == 0.25) continue;
    Sweep sweep;
    sweep.base.cells_across = 10.0;
    sweep.cells = full ? std::vector<double>{4, 6, 8, 10, 16, 32} : std::vector<double>{4, 10};
    if (ratio == 0.8) sweep.cells = full ? std::vector<double>{10, 16, 32, 64} : std::vector<double>{10};
    sweep.fractions = full;
    char name[64];
    std::snprintf(name, sizeof name, "Taylor-Couette, radii 1:%g", 1.0 / ratio);
    RunFunction run = [ratio](const Numerics& n, Meter& meter) { return torque(ratio, n, meter); };
    // In the narrow gap, 1.3 cells wide, the goal is missed.
    if (!full && ratio == 0.8) run = atMost(0.095, kInnerTorque, atMost(0.095, kRingTorque, run));
    addSweep(name, sweep, run, out);
  }
  return out;
}

}  // namespace

Case cylinder() {
  Case c;
  c.name = "cylinder";
  c.title = "drag of a cylinder in a channel, and Taylor-Couette flow";
  c.reference = "method of fundamental solutions (Faxen 1946); analytic";
  c.across = "diameter of the (inner) cylinder";
  c.steady = true;
  c.variants = variants;
  return c;
}

}  // namespace monolith
