#include "geometry/shape.h"

#include <algorithm>
#include <stdexcept>

#include "geometry/mesh.h"
#include "geometry/mesh_distance.h"
#include "geometry/shape_distance.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// A distance field placed in another frame. The bounds come from the shape, because the box around a turned box
// is larger than the one around a turned sphere.
struct Placed {
  std::shared_ptr<const SignedDistance> field;
  Isometry3d X_GB;
  AlignedBox3d bounds_B;

  DistanceSample sample(const Vector3d& p_B) const {
    DistanceSample sample = field->sample(X_GB * p_B);
    sample.gradient = X_GB.linear().transpose() * sample.gradient;
    return sample;
  }
};

class UnionDistance : public SignedDistance {
 public:
  explicit UnionDistance(std::vector<Placed> parts) : parts_(std::move(parts)) {
    for (const Placed& part : parts_) bounds_.extend(part.bounds_B);
  }

  DistanceSample sample(const Vector3d& point) const override {
    DistanceSample nearest = parts_.front().sample(point);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      if (cannotBeNearer(parts_[i], point, nearest.distance)) continue;
      const DistanceSample candidate = parts_[i].sample(point);
      if (candidate.distance < nearest.distance) nearest = candidate;
    }
    return nearest;
  }

  double distance(const Vector3d& point) const override {
    double nearest = parts_.front().field->distance(parts_.front().X_GB * point);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      if (cannotBeNearer(parts_[i], point, nearest)) continue;
      nearest = std::min(nearest, parts_[i].field->distance(parts_[i].X_GB * point));
    }
    return nearest;
  }

  AlignedBox3d bounds() const override { return bounds_; }

 private:
  // No field is below the distance to the box around its solid.
  static bool cannotBeNearer(const Placed& part, const Vector3d& point, double distance) {
    return distance > 0.0 ? part.bounds_B.squaredExteriorDistance(point) > distance * distance
                          : !part.bounds_B.contains(point);
  }

  std::vector<Placed> parts_;
  AlignedBox3d bounds_;
};

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
  std::vector<Placed> parts;
  for (const Shape& shape : shapes) {
    parts.push_back({makeSignedDistance(shape, resolution), shape.X_BG.inverse(), bounds(shape, identity)});
  }
  return std::make_shared<UnionDistance>(std::move(parts));
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
