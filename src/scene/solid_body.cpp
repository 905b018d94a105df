#include "scene/solid_body.h"

#include <utility>

#include "scene/joint_placement.h"

namespace monolith {
namespace {

BodyDescription solidBody(Shape shape, double density, const Eigen::Vector3d& position) {
  BodyDescription body;
  body.name = shape.name;
  body.mass = density * volume(shape);
  body.shapes = {std::move(shape)};
  body.X_WB.translation() = position;
  return body;
}

}  // namespace

BodyDescription sphereBody(const std::string& name, double radius, double density, const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = radius;
  shape.name = name;
  BodyDescription body = solidBody(shape, density, position);
  body.inertia_Bcm = 0.4 * body.mass * radius * radius * Eigen::Matrix3d::Identity();
  return body;
}

BodyDescription boxBody(const std::string& name, const Eigen::Vector3d& size, double density,
                        const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = size;
  shape.name = name;
  BodyDescription body = solidBody(shape, density, position);
  const Eigen::Vector3d s = size.cwiseProduct(size);
  body.inertia_Bcm = body.mass / 12.0 * Eigen::Vector3d(s[1] + s[2], s[0] + s[2], s[0] + s[1]).asDiagonal();
  return body;
}

BodyDescription cylinderBody(const std::string& name, double radius, double length, double density,
                             const Eigen::Vector3d& position) {
  Shape shape;
  shape.kind = Shape::Kind::kCylinder;
  shape.radius = radius;
  shape.length = length;
  shape.name = name;
  BodyDescription body = solidBody(shape, density, position);
  const double across = (3.0 * radius * radius + length * length) / 12.0;
  body.inertia_Bcm = body.mass * Eigen::Vector3d(across, across, 0.5 * radius * radius).asDiagonal();
  return body;
}

BodyDescription& hangOn(std::vector<BodyDescription>& bodies, int parent, BodyDescription body,
                        JointDescription joint) {
  int root = parent;
  while (bodies[root].joint) root = bodies[root].joint->parent;
  body.name = bodies[root].name + "/" + body.name;
  body.motion = BodyMotion::kFree;
  joint.parent = parent;
  body.joint = std::move(joint);
  placeOnParent(bodies[parent], body);
  bodies.push_back(std::move(body));
  return bodies.back();
}

}  // namespace monolith
