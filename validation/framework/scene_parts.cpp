#include "framework/scene_parts.h"

namespace monolith {
namespace {

BodyDescription solid(const std::string& name, const Shape& shape, double density, const Eigen::Vector3d& position) {
  BodyDescription body;
  body.name = name;
  body.shapes = {shape};
  body.shapes[0].name = name;
  body.mass = density * volume(shape);
  body.X_WB.translation() = position;
  return body;
}

}  // namespace

std::string shippedScene(const std::string& name) {
  return std::string(MONOLITH_SOURCE_DIR "/config/scenes/") + name + ".yaml";
}

BodyDescription sphereBody(const std::string& name, double radius, double density, const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = radius;
  BodyDescription body = solid(name, shape, density, position);
  body.inertia_Bcm = 0.4 * body.mass * radius * radius * Eigen::Matrix3d::Identity();
  return body;
}

BodyDescription boxBody(const std::string& name, const Eigen::Vector3d& size, double density,
                        const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = size;
  BodyDescription body = solid(name, shape, density, position);
  const Eigen::Vector3d s2 = size.cwiseProduct(size);
  body.inertia_Bcm = body.mass / 12.0 * Eigen::Vector3d(s2[1] + s2[2], s2[0] + s2[2], s2[0] + s2[1]).asDiagonal();
  return body;
}

BodyDescription cylinderBody(const std::string& name, double radius, double length, double density,
                             const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kCylinder;
  shape.radius = radius;
  shape.length = length;
  BodyDescription body = solid(name, shape, density, position);
  const double across = (3.0 * radius * radius + length * length) / 12.0;
  body.inertia_Bcm = body.mass * Eigen::Vector3d(across, across, 0.5 * radius * radius).asDiagonal();
  return body;
}

void apply(const Numerics& numerics, Scene& scene) {
  if (numerics.dt > 0.0) scene.time_step = numerics.dt;
  scene.solver.tolerance = numerics.tolerance;
  scene.solver.name = numerics.solver;
  scene.solver.discretisation = numerics.discretisation;
  scene.solver.threads = 1;
}

}  // namespace monolith
