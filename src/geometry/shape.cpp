#include "geometry/shape.h"

#include <stdexcept>

#include "geometry/mesh.h"
#include "geometry/mesh_distance.h"
#include "geometry/shape_distance.h"
#include "geometry/union_distance.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

}  // namespace

std::shared_ptr<const SignedDistance> makeSignedDistance(const Shape& shape, double resolution) {
  switch (shape.kind) {
    case Shape::Kind::kBox: return makeBoxDistance(shape.box_size);
    case Shape::Kind::kSphere: return makeSphereDistance(shape.radius);
    case Shape::Kind::kCylinder: return makeCylinderDistance(shape.radius, shape.length);
    case Shape::Kind::kMesh: return makeMeshDistance(*shape.mesh, resolution);
  }
  throw std::invalid_argument("makeSignedDistance: unknown kind of shape");
}

std::shared_ptr<const SignedDistance> makeSignedDistance(const std::vector<Shape>& shapes,
                                                         double resolution) {
  if (shapes.empty()) throw std::invalid_argument("makeSignedDistance: a body needs at least one shape");
  const Isometry3d identity = Isometry3d::Identity();
  if (shapes.size() == 1 && shapes.front().X_BG.matrix() == identity.matrix()) {
    return makeSignedDistance(shapes.front(), resolution);
  }
  std::vector<PlacedSolid> parts;
  for (const Shape& shape : shapes) {
    parts.push_back({makeSignedDistance(shape, resolution), shape.X_BG.inverse(), bounds(shape, identity)});
  }
  return makeUnionDistance(std::move(parts), resolution);
}

double volume(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::kBox: return shape.box_size.prod();
    case Shape::Kind::kSphere: return 4.0 / 3.0 * M_PI * shape.radius * shape.radius * shape.radius;
    case Shape::Kind::kCylinder: return M_PI * shape.radius * shape.radius * shape.length;
    case Shape::Kind::kMesh: return signedVolume(*shape.mesh);
  }
  throw std::invalid_argument("volume: unknown kind of shape");
}

std::optional<Displacement> displacement(const std::vector<Shape>& shapes) {
  Displacement whole;
  std::vector<AlignedBox3d> boxes;
  for (const Shape& shape : shapes) {
    const AlignedBox3d box = bounds(shape, Isometry3d::Identity());
    for (const AlignedBox3d& other : boxes) {
      // Shapes that only touch, but for round-off, do not overlap.
      const Vector3d common = box.max().cwiseMin(other.max()) - box.min().cwiseMax(other.min());
      if (common.minCoeff() > 1e-9 * box.sizes().minCoeff()) return std::nullopt;
    }
    boxes.push_back(box);
    const double part = volume(shape);
    whole.volume += part;
    whole.centre += part * (shape.X_BG * (shape.kind == Shape::Kind::kMesh ? centroid(*shape.mesh) : Vector3d::Zero()));
  }
  whole.centre /= whole.volume;
  return whole;
}

AlignedBox3d bounds(const Shape& shape, const Isometry3d& X_AB) {
  const Isometry3d X_AG = X_AB * shape.X_BG;
  const Vector3d centre = X_AG.translation();
  Vector3d half = Vector3d::Zero();
  switch (shape.kind) {
    case Shape::Kind::kBox: half = X_AG.linear().cwiseAbs() * (0.5 * shape.box_size); break;
    case Shape::Kind::kSphere: half.setConstant(shape.radius); break;
    case Shape::Kind::kCylinder: {
      const Vector3d axis = X_AG.linear().col(2);
      // The rim is a circle: its extent along an axis of A is the radius times the sine of the angle to it.
      const Vector3d sine = (1.0 - axis.array().square()).max(0.0).sqrt();
      half = 0.5 * shape.length * axis.cwiseAbs() + shape.radius * sine;
      break;
    }
    case Shape::Kind::kMesh: {
      AlignedBox3d box;
      for (const Vector3d& vertex : shape.mesh->vertices) box.extend(X_AG * vertex);
      return box;
    }
  }
  return AlignedBox3d(centre - half, centre + half);
}

}  // namespace monolith
