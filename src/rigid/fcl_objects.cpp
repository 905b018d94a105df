#include "rigid/fcl_objects.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <stdexcept>

namespace monolith {

std::shared_ptr<fcl::CollisionGeometryd> makeCollisionGeometry(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::kBox: return std::make_shared<fcl::Boxd>(shape.box_size);
    case Shape::Kind::kSphere: return std::make_shared<fcl::Sphered>(shape.radius);
    case Shape::Kind::kCylinder: return std::make_shared<fcl::Cylinderd>(shape.radius, shape.length);
    case Shape::Kind::kMesh: {
      auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
      std::vector<fcl::Triangle> triangles;
      for (const Eigen::Vector3i& t : shape.mesh->triangles) triangles.emplace_back(t[0], t[1], t[2]);
      model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(shape.mesh->vertices.size()));
      model->addSubModel(shape.mesh->vertices, triangles);
      model->endModel();
      return model;
    }
  }
  throw std::invalid_argument("makeCollisionGeometry: unknown kind of shape " + shape.name);
}

ClosestPair findClosestPair(const fcl::CollisionGeometryd& a, const Eigen::Isometry3d& X_WA,
                            const fcl::CollisionGeometryd& b, const Eigen::Isometry3d& X_WB, double most) {
  fcl::DistanceRequestd request;
  request.enable_nearest_points = true;
  fcl::DistanceResultd result(most);
  const double distance = fcl::distance(&a, X_WA, &b, X_WB, request, result);
  return {distance > 0.0 ? distance : -1.0, result.nearest_points[0], result.nearest_points[1]};
}

}  // namespace monolith
