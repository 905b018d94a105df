#include "geometry/shape_distance.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

double signOf(double x) { return x < 0.0 ? -1.0 : 1.0; }

class BoxDistance : public SignedDistance {
 public:
  explicit BoxDistance(const Vector3d& size) : half_(0.5 * size) {}

  DistanceSample sample(const Vector3d& point) const override {
    const Vector3d excess = point.cwiseAbs() - half_;
    const Vector3d outside = excess.cwiseMax(0.0);
    const double norm = outside.norm();
    Vector3d gradient = Vector3d::Zero();
    if (norm > 0.0) {
      for (int axis = 0; axis < 3; ++axis) gradient[axis] = outside[axis] / norm * signOf(point[axis]);
      return {norm, gradient};
    }
    int axis;
    const double depth = excess.maxCoeff(&axis);
    gradient[axis] = signOf(point[axis]);
    return {depth, gradient};
  }

  double distance(const Vector3d& point) const override {
    const Vector3d excess = point.cwiseAbs() - half_;
    return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
  }

  void appendFaces(const Vector3d& point, double reach, SolidFaces& faces) const override {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const double distance = side * point[axis] - half_[axis];
        if (distance >= -reach) faces.append(distance, side * Vector3d::Unit(axis));
      }
    }
  }

  AlignedBox3d bounds() const override { return AlignedBox3d(-half_, half_); }

 private:
  Vector3d half_;
};

class SphereDistance : public SignedDistance {
 public:
  explicit SphereDistance(double radius) : radius_(radius) {}

  DistanceSample sample(const Vector3d& point) const override {
    const double norm = point.norm();
    const Vector3d gradient = norm > 0.0 ? Vector3d(point / norm) : Vector3d::UnitX();
    return {norm - radius_, gradient};
  }

  double distance(const Vector3d& point) const override { return point.norm() - radius_; }

  AlignedBox3d bounds() const override {
    return AlignedBox3d(Vector3d::Constant(-radius_), Vector3d::Constant(radius_));
  }

 private:
  double radius_;
};

// A rectangle in the plane of the distance from the axis and the height.
class CylinderDistance : public SignedDistance {
 public:
  CylinderDistance(double radius, double length) : radius_(radius), half_length_(0.5 * length) {}

  DistanceSample sample(const Vector3d& point) const override {
    const double axis_distance = point.head<2>().norm();
    const Vector3d radial = axis_distance > 0.0
                                ? Vector3d(point.x() / axis_distance, point.y() / axis_distance, 0.0)
                                : Vector3d::UnitX();
    const Vector3d axial(0.0, 0.0, signOf(point.z()));
    const double radial_excess = axis_distance - radius_;
    const double axial_excess = std::abs(point.z()) - half_length_;
    const double radial_outside = std::max(radial_excess, 0.0);
    const double axial_outside = std::max(axial_excess, 0.0);
    const double norm = std::sqrt(radial_outside * radial_outside + axial_outside * axial_outside);
    if (norm > 0.0) return {norm, radial * (radial_outside / norm) + axial * (axial_outside / norm)};
    if (radial_excess > axial_excess) return {radial_excess, radial};
    return {axial_excess, axial};
  }

  double distance(const Vector3d& point) const override {
    const double radial = point.head<2>().norm() - radius_, axial = std::abs(point.z()) - half_length_;
    const double radial_outside = std::max(radial, 0.0), axial_outside = std::max(axial, 0.0);
    return std::sqrt(radial_outside * radial_outside + axial_outside * axial_outside) +
           std::min(std::max(radial, axial), 0.0);
  }

  void appendFaces(const Vector3d& point, double /*reach*/, SolidFaces& faces) const override {
    const double axis_distance = point.head<2>().norm();
    const Vector3d radial =
        axis_distance > 0.0 ? Vector3d(point.x() / axis_distance, point.y() / axis_distance, 0.0) : Vector3d::UnitX();
    faces.append(axis_distance - radius_, radial);
    for (const double side : {-1.0, 1.0}) faces.append(side * point.z() - half_length_, side * Vector3d::UnitZ());
  }

  AlignedBox3d bounds() const override {
    const Vector3d half(radius_, radius_, half_length_);
    return AlignedBox3d(-half, half);
  }

 private:
  double radius_;
  double half_length_;
};

}  // namespace

std::shared_ptr<const SignedDistance> makeBoxDistance(const Vector3d& size) {
  return std::make_shared<BoxDistance>(size);
}

std::shared_ptr<const SignedDistance> makeSphereDistance(double radius) {
  return std::make_shared<SphereDistance>(radius);
}

std::shared_ptr<const SignedDistance> makeCylinderDistance(double radius, double length) {
  return std::make_shared<CylinderDistance>(radius, length);
}

}  // namespace monolith
