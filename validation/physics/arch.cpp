// A semicircular arch of wedges without mortar stands by friction alone, on the tank's floor, dry and under liquid:
// from which coefficient of friction on. Everything rests on the contact forces between eight joints, none of which may
// creep.

#include <cmath>
#include <memory>

#include "framework/meter.h"
#include "framework/scene_parts.h"
#include "geometry/mesh.h"

namespace monolith {
namespace {

constexpr int kWedges = 7;
constexpr double kRadius = 0.4;  // m, of the middle line
constexpr double kThickness = 0.24 * kRadius;
constexpr double kDepth = 0.16;  // m
constexpr double kSeconds = 0.6;
constexpr double kFallen = 2e-3;  // m that the keystone sinks
constexpr double kReference = 0.2982;

std::shared_ptr<const TriangleMesh> wedge(double from, double to, const Eigen::Vector3d& centre) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = "wedge";
  for (const double y : {-0.5 * kDepth, 0.5 * kDepth}) {
    for (const double angle : {from, to}) {
      for (const double radius : {kRadius - 0.5 * kThickness, kRadius + 0.5 * kThickness}) {
        mesh->vertices.push_back(Eigen::Vector3d(radius * std::cos(angle), y, radius * std::sin(angle)) - centre);
      }
    }
  }
  // Vertices: + 4 behind, + 2 at `to`, + 1 outside.
  const int quads[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}};
  for (const auto& q : quads) {
    mesh->triangles.emplace_back(q[0], q[1], q[2]);
    mesh->triangles.emplace_back(q[0], q[2], q[3]);
  }
  if (signedVolume(*mesh) < 0.0) flipOrientation(*mesh);
  return mesh;
}

Scene arch(double friction, bool wet, const Numerics& numerics) {
  Scene scene;
  scene.name = "arch";
  scene.tank.cell_width = kThickness / std::round(numerics.cells_across);
  const double h = scene.tank.cell_width;
  scene.tank.size = h * Eigen::Vector3d(std::ceil(1.2 / h), std::ceil(0.3 / h), std::ceil(0.6 / h));
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = 0.1;
  scene.liquid.fill_level = wet ? scene.tank.size[2] : 0.0;
  scene.contact.friction = friction;
  scene.time_step = 0.02;
  const Eigen::Vector3d foot(0.5 * scene.tank.size[0], 0.5 * scene.tank.size[1], 0.0);
  for (int i = 0; i < kWedges; ++i) {
    const double from = M_PI * i / kWedges, to = M_PI * (i + 1) / kWedges;
    // Centroid of the trapezium.
    const double half = 0.5 * (to - from), inner = kRadius - 0.5 * kThickness, outer = kRadius + 0.5 * kThickness;
    const double mean = 2.0 / 3.0 * std::cos(half) * (outer * outer + outer * inner + inner * inner) / (outer + inner);
    const double angle = from + half;
    const Eigen::Vector3d centre = mean * Eigen::Vector3d(std::cos(angle), 0.0, std::sin(angle));
    const Eigen::Vector3d size(kThickness, kDepth, (inner + outer) * std::sin(half));
    BodyDescription body = boxBody("wedge" + std::to_string(i), size, 2500.0, foot + centre);
    body.shapes[0].kind = Shape::Kind::kMesh;
    body.shapes[0].mesh = wedge(from, to, centre);
    body.mass = 2500.0 * volume(body.shapes[0]);
    scene.bodies.push_back(body);
  }
  apply(numerics, scene);
  return scene;
}

double keystoneSinks(double friction, bool wet, const Numerics& numerics, Meter& meter) {
  Simulation simulation(arch(friction, wet, numerics));
  const double start = simulation.bodyStates()[kWedges / 2].X_WB.translation()[2];
  double sinks = 0.0;
  while (simulation.time() < kSeconds && sinks < kFallen) {
    meter.step(simulation);
    sinks = start - simulation.bodyStates()[kWedges / 2].X_WB.translation()[2];
  }
  return sinks;
}

std::vector<Measurement> run(bool wet, const Numerics& numerics, Meter& meter) {
  const double stands = keystoneSinks(1.2 * kReference, wet, numerics, meter);
  std::vector<Measurement> out = {
      observed("stands with 1.2 times the friction that it needs", stands < 0.1 * kFallen),
      observed("falls with 0.8 times", keystoneSinks(0.8 * kReference, wet, numerics, meter) >= kFallen)};
  if (wet) return out;
  double low = 0.8 * kReference, high = 1.2 * kReference;
  while (high - low > 0.005 * kReference) {
    const double middle = 0.5 * (low + high);
    (keystoneSinks(middle, wet, numerics, meter) > 0.1 * kFallen ? low : high) = middle;
  }
  out.push_back({"least friction", 0.5 * (low + high), kReference, 0.01});
  return out;
}

std::vector<Variant> variants(Extent extent) {
  std::vector<Variant> out;
  for (const bool wet : {false, true}) {
    if (extent == Extent::kQuick && wet) continue;
    Sweep sweep;
    sweep.base.cells_across = 3.0;
    sweep.base.dt = 0.02;
    addSweep(
        wet ? "wet" : "dry", sweep, [wet](const Numerics& n, Meter& meter) { return run(wet, n, meter); }, out);
  }
  return out;
}

}  // namespace

Case masonryArch() {
  Case c;
  c.name = "arch";
  c.title = "a semicircular arch of seven wedges that stands by friction, dry and under liquid";
  c.reference =
      "limit analysis by linear programming (Cocchetti & Rizzi 2020, Fracture Struct. Integrity 51, 356), wedges with "
      "round faces";
  c.across = "thickness of the arch";
  c.variants = variants;
  return c;
}

}  // namespace monolith
