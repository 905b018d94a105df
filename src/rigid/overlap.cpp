#include "rigid/overlap.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "rigid/articulation.h"
#include "rigid/convex_separation.h"
#include "rigid/mesh_manifold.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kEdgePoints = 32;  // that an edge is sampled at

struct Solid {
  Shape shape;
  Isometry3d X_WG;
  std::shared_ptr<const MeshSurface> surface;  // of a mesh

  PlacedMesh mesh() const { return {surface.get(), X_WG}; }
  ConvexShape convex() const { return placeConvex(shape, X_WG); }
  double distance(const Vector3d& point) const {
    return surface ? mesh().sample(point).distance : sampleDistance(convex(), point).distance;
  }
};

std::vector<Vector3d> meshPoints(const MeshSurface& surface) {
  std::vector<Vector3d> points = surface.vertices();
  for (const Eigen::Vector3i& triangle : surface.triangles()) {
    Vector3d corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = surface.vertices()[triangle[k]];
    points.push_back((corner[0] + corner[1] + corner[2]) / 3.0);
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] > triangle[(k + 1) % 3]) continue;  // each edge from one of its triangles
      for (int i = 1; i < kEdgePoints; ++i) {
        points.push_back(corner[k] + (corner[(k + 1) % 3] - corner[k]) * (double(i) / kEdgePoints));
      }
    }
  }
  return points;
}

// Centre, face centres and edges of a box; axis, rims and side of a cylinder; centre and poles of a sphere.
std::vector<Vector3d> convexPoints(const ConvexShape& shape) {
  std::vector<Vector3d> points{shape.centre()};
  const int n = kEdgePoints / 2;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k) {
        const bool on_edge = (std::abs(i) == n) + (std::abs(j) == n) + (std::abs(k) == n) >= 2;
        const bool coarse = i % (n / 4) == 0 && j % (n / 4) == 0 && k % (n / 4) == 0;
        if (!on_edge && !coarse) continue;
        const Vector3d direction = Vector3d(i, j, k) / n;
        if (shape.kind == Shape::Kind::kBox) {
          points.push_back(shape.X_WG * Vector3d(direction.cwiseProduct(shape.half)));
        } else if (i != 0 || j != 0 || k != 0) {
          points.push_back(supportPoint(shape, shape.X_WG.linear() * direction.normalized()));
        }
      }
  return points;
}

double depth(const Solid& a, const Solid& b) {
  if (!a.surface && !b.surface) return -findSeparation(a.convex(), b.convex()).distance;
  double deepest = 0.0;
  const auto sampleOf = [&](const Solid& solid, const Solid& in) {
    const Eigen::AlignedBox3d box = bounds(in.shape, in.X_WG * in.shape.X_BG.inverse());
    if (!box.intersects(bounds(solid.shape, solid.X_WG * solid.shape.X_BG.inverse()))) return;
    if (!solid.surface && solid.shape.kind == Shape::Kind::kSphere) {
      deepest = std::max(deepest, solid.shape.radius - in.distance(solid.X_WG.translation()));
      return;
    }
    std::vector<Vector3d> points;
    if (solid.surface) {
      for (const Vector3d& point : meshPoints(*solid.surface)) points.push_back(solid.X_WG * point);
    } else {
      points = convexPoints(solid.convex());
    }
    for (const Vector3d& point : points) {
      if (box.contains(point)) deepest = std::max(deepest, -in.distance(point));
    }
  };
  sampleOf(a, b);
  sampleOf(b, a);
  return deepest;
}

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g m", length);
  return text;
}

}  // namespace

std::string describeOverlaps(const std::vector<RigidBody>& bodies, const TankWalls& walls, double tolerance, int only) {
  const std::vector<int> roots = rootsOf(bodies);
  const auto counts = [&](std::size_t body) {
    return only < 0 || roots[body] == roots[static_cast<std::size_t>(only)];
  };
  std::map<const TriangleMesh*, std::shared_ptr<const MeshSurface>> surfaces;
  std::vector<std::vector<Solid>> solids(bodies.size());
  std::vector<Eigen::AlignedBox3d> boxes(bodies.size());
  std::string lines;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Eigen::AlignedBox3d& box = boxes[i];
    for (const Shape& shape : bodies[i].shapes) {
      Solid solid{shape, bodies[i].pose() * shape.X_BG, nullptr};
      if (shape.kind == Shape::Kind::kMesh) {
        auto& surface = surfaces[shape.mesh.get()];
        if (!surface) surface = std::make_shared<MeshSurface>(*shape.mesh);
        solid.surface = surface;
      }
      solids[i].push_back(std::move(solid));
      box.extend(bounds(shape, bodies[i].pose()));
    }
    if (!counts(i)) continue;
    forEachWallDepth(walls, box, [&](const std::string& wall, double depth) {
      if (!(depth > tolerance)) return;
      lines += "body '" + bodies[i].name + "' sticks out of the tank's wall " + wall + " by " + metres(depth) + "\n";
    });
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if ((!counts(i) && !counts(j)) || !mayTouch(bodies, roots, i, j)) continue;
      const auto deepest = [&](const Vector3d& shift) {
        double most = 0.0;
        for (Solid b : solids[j]) {
          b.X_WG.translation() += shift;
          for (const Solid& a : solids[i]) most = std::max(most, depth(a, b));
        }
        return most;
      };
      const double inside = deepest(Vector3d::Zero());
      double across = 0.0;
      walls.forEachImage(boxes[i], boxes[j], [&](const Vector3d& shift, const std::array<int, 3>&) {
        across = std::max(across, deepest(shift));
      });
      if (!(std::max(inside, across) > tolerance)) continue;
      lines += "bodies '" + bodies[i].name + "' and '" + bodies[j].name + "' overlap by " +
               metres(std::max(inside, across)) + (across > inside ? ", across the periodic boundary" : "") + "\n";
    }
  }
  return lines;
}

}  // namespace monolith
