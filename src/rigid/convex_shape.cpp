#include "rigid/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr int kRimPoints = 16;

double signOf(double x) { return x < 0.0 ? -1.0 : 1.0; }

// Unit vector across the axis that leans most towards `direction`; the shape's x axis where none does.
Vector3d radialTowards(const ConvexShape& cylinder, const Vector3d& direction) {
  // In the cylinder's own axes: a small difference of vectors in W would not be square to the axis.
  const double x = cylinder.axis(0).dot(direction), y = cylinder.axis(1).dot(direction);
  const double norm = std::hypot(x, y);
  return norm > 1e-12 ? Vector3d((x * cylinder.axis(0) + y * cylinder.axis(1)) / norm) : cylinder.axis(0);
}

Polygon sideLine(const ConvexShape& cylinder, const Vector3d& direction) {
  const Vector3d middle = cylinder.centre() + cylinder.radius * radialTowards(cylinder, direction);
  const Vector3d half_axis = cylinder.half_length * cylinder.axis(2);
  return {middle - half_axis, middle + half_axis};
}

Face capTowards(const ConvexShape& cylinder, const Vector3d& direction) {
  Face face;
  const double side = signOf(cylinder.axis(2).dot(direction));
  face.normal = side * cylinder.axis(2);
  const Vector3d centre = cylinder.centre() + cylinder.half_length * face.normal;
  const Vector3d x = cylinder.axis(0);
  const Vector3d y = side * cylinder.axis(1);
  const Vector3d radial = radialTowards(cylinder, direction);
  double lowest = std::atan2(radial.dot(y), radial.dot(x));
  if (lowest < 0.0) lowest += 2.0 * M_PI;
  const double spacing = 2.0 * M_PI / kRimPoints;
  const auto rimPoint = [&](double angle) -> Vector3d {
    return centre + cylinder.radius * (std::cos(angle) * x + std::sin(angle) * y);
  };
  for (int i = 0; i < kRimPoints; ++i) {
    face.polygon.push_back(rimPoint(i * spacing));
    const double offset = lowest - i * spacing;
    if (offset > 1e-6 * spacing && offset < (1.0 - 1e-6) * spacing) face.polygon.push_back(rimPoint(lowest));
  }
  return face;
}

Face boxFaceTowards(const ConvexShape& box, const Vector3d& direction) {
  int k = 0;
  const Vector3d cosines = box.X_WG.linear().transpose() * direction;
  cosines.cwiseAbs().maxCoeff(&k);
  const double side = signOf(cosines[k]);
  Face face;
  face.normal = side * box.axis(k);
  const Vector3d centre = box.centre() + box.half[k] * face.normal;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const Vector3d u = side * box.half[i] * box.axis(i);
  const Vector3d v = box.half[j] * box.axis(j);
  face.polygon = {centre + u + v, centre - u + v, centre - u - v, centre + u - v};
  return face;
}

}  // namespace

ConvexShape placeConvex(const Shape& shape, const Eigen::Isometry3d& X_WG) {
  ConvexShape convex;
  convex.kind = shape.kind;
  convex.X_WG = X_WG;
  switch (shape.kind) {
    case Shape::Kind::kBox: convex.half = 0.5 * shape.box_size; break;
    case Shape::Kind::kSphere: convex.radius = shape.radius; break;
    case Shape::Kind::kCylinder:
      convex.radius = shape.radius;
      convex.half_length = 0.5 * shape.length;
      break;
    case Shape::Kind::kMesh: throw std::invalid_argument("placeConvex: " + shape.name + " is a mesh");
  }
  return convex;
}

Vector3d supportPoint(const ConvexShape& shape, const Vector3d& direction) {
  Vector3d point = shape.centre();
  switch (shape.kind) {
    case Shape::Kind::kBox:
      for (int k = 0; k < 3; ++k) point += signOf(shape.axis(k).dot(direction)) * shape.half[k] * shape.axis(k);
      break;
    case Shape::Kind::kSphere: point += shape.radius * direction; break;
    default:
      point += signOf(shape.axis(2).dot(direction)) * shape.half_length * shape.axis(2) +
               shape.radius * radialTowards(shape, direction);
  }
  return point;
}

DistanceSample sampleDistance(const ConvexShape& shape, const Vector3d& point) {
  const Vector3d p = shape.X_WG.linear().transpose() * (point - shape.centre());
  if (shape.kind == Shape::Kind::kSphere) {
    const double norm = p.norm();
    const Vector3d gradient = norm > 0.0 ? Vector3d((point - shape.centre()) / norm) : shape.axis(0);
    return {norm - shape.radius, gradient};
  }
  // A box is a box of |x|, |y|, |z|; a cylinder is a rectangle of the distance from the axis and |z|.
  Vector3d excess, direction[3];
  int dimensions = 3;
  if (shape.kind == Shape::Kind::kBox) {
    excess = p.cwiseAbs() - shape.half;
    for (int k = 0; k < 3; ++k) direction[k] = signOf(p[k]) * shape.axis(k);
  } else {
    const double from_axis = p.head<2>().norm();
    dimensions = 2;
    excess << from_axis - shape.radius, std::abs(p.z()) - shape.half_length, -1.0;
    direction[0] =
        from_axis > 0.0 ? Vector3d((p.x() * shape.axis(0) + p.y() * shape.axis(1)) / from_axis) : shape.axis(0);
    direction[1] = signOf(p.z()) * shape.axis(2);
  }
  Vector3d outside = Vector3d::Zero();
  int nearest = 0;
  double squared = 0.0;
  for (int k = 0; k < dimensions; ++k) {
    const double e = std::max(excess[k], 0.0);
    outside += e * direction[k];
    squared += e * e;
    if (excess[k] > excess[nearest]) nearest = k;
  }
  if (squared == 0.0) return {excess[nearest], direction[nearest]};
  const double distance = std::sqrt(squared);
  return {distance, outside / distance};
}

std::vector<Vector3d> boxCorners(const ConvexShape& box) {
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    corners.push_back(box.X_WG * Vector3d(sign.cwiseProduct(box.half)));
  }
  return corners;
}

Face faceTowards(const ConvexShape& shape, const Vector3d& direction) {
  if (shape.kind == Shape::Kind::kBox) return boxFaceTowards(shape, direction);
  if (shape.kind == Shape::Kind::kCylinder) return capTowards(shape, direction);
  return {{supportPoint(shape, direction)}, direction};
}

Polygon pieceTowards(const ConvexShape& shape, const Vector3d& direction) {
  const bool lies = shape.kind == Shape::Kind::kCylinder && std::abs(shape.axis(2).dot(direction)) < std::sqrt(0.5);
  return lies ? sideLine(shape, direction) : faceTowards(shape, direction).polygon;
}

Polygon edgeTowards(const ConvexShape& shape, const Vector3d& direction) {
  if (shape.kind == Shape::Kind::kCylinder && std::abs(shape.axis(2).dot(direction)) < std::sqrt(0.5)) {
    return sideLine(shape, direction);
  }
  if (shape.kind != Shape::Kind::kBox) return {supportPoint(shape, direction)};
  int k = 0;
  (shape.X_WG.linear().transpose() * direction).cwiseAbs().minCoeff(&k);
  const Vector3d support = supportPoint(shape, direction);
  const double side = signOf(shape.axis(k).dot(support - shape.centre()));
  return {support, support - 2.0 * side * shape.half[k] * shape.axis(k)};
}

}  // namespace monolith
