#include <cmath>
#include <cstdio>

#include "cases.h"

namespace monolith {

std::string shippedScene(const std::string& name) { return std::string(MONOLITH_SOURCE_DIR "/config/scenes/") + name + ".yaml"; }

BodyDescription sphereBody(const std::string& name, double radius, double density, const Eigen::Vector3d& position) {
  BodyDescription body;
  body.name = name;
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = radius;
  shape.name = name;
  body.shapes = {shape};
  body.mass = density * volume(shape);
  body.inertia_Bcm = 0.4 * body.mass * radius * radius * Eigen::Matrix3d::Identity();
  body.X_WB.translation() = position;
  return body;
}

BodyDescription boxBody(const std::string& name, const Eigen::Vector3d& size, double density,
                        const Eigen::Vector3d& position) {
  BodyDescription body;
  body.name = name;
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = size;
  shape.name = name;
  body.shapes = {shape};
  body.mass = density * size.prod();
  const Eigen::Vector3d s2 = size.cwiseProduct(size);
  body.inertia_Bcm = body.mass / 12.0 * Eigen::Vector3d(s2[1] + s2[2], s2[0] + s2[2], s2[0] + s2[1]).asDiagonal();
  body.X_WB.translation() = position;
  return body;
}

bool report(const std::string& variant, const std::string& quantity, double result, double reference, double goal) {
  const double error = result / reference - 1.0;
  const bool met = std::abs(error) <= goal;
  std::printf("%-34s %-22s %12.6g  reference %12.6g  error %+7.2f %%  goal %4.1f %%  %s\n", variant.c_str(),
              quantity.c_str(), result, reference, 100.0 * error, 100.0 * goal, met ? "met" : "MISSED");
  std::fflush(stdout);
  return met;
}

}  // namespace monolith
