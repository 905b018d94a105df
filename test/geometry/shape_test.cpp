// Distances of primitives and unions, by what defines them: the foot point p - d grad is on the surface, no
// sampled surface point is nearer than |d|, the sign is that of the analytic inside test, and |grad| = 1.

#include "geometry/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Vector3d inCube(double half) { return Vector3d(uniform(-half, half), uniform(-half, half), uniform(-half, half)); }
  Isometry3d pose(double half) {
    Isometry3d X = Isometry3d::Identity();
    X.linear() = Eigen::AngleAxisd(uniform(0.0, 3.0), inCube(1.0).normalized()).toRotationMatrix();
    X.translation() = inCube(half);
    return X;
  }

 private:
  std::mt19937 engine_;
};

Shape box(double x, double y, double z) {
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = Vector3d(x, y, z);
  return shape;
}

Shape sphere(double radius) {
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = radius;
  return shape;
}

Shape cylinder(double radius, double length) {
  Shape shape;
  shape.kind = Shape::Kind::kCylinder;
  shape.radius = radius;
  shape.length = length;
  return shape;
}

// In the shape's own frame.
bool isInside(const Shape& shape, const Vector3d& p) {
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return (2.0 * p.cwiseAbs().array() <= shape.box_size.array()).all();
    case Shape::Kind::kSphere:
      return p.norm() <= shape.radius;
    default:
      return p.head<2>().norm() <= shape.radius && 2.0 * std::abs(p.z()) <= shape.length;
  }
}

// A point of the surface in the shape's own frame; every part of it is reached.
Vector3d surfacePoint(const Shape& shape, Random& random) {
  Vector3d p = random.inCube(1.0);
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      return shape.radius * p.normalized();
    case Shape::Kind::kBox: {
      const int axis = static_cast<int>(random.uniform(0.0, 3.0));
      p[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
      return 0.5 * p.cwiseProduct(shape.box_size);
    }
    default: {
      const double angle = M_PI * p.x();
      const bool on_cap = p.y() < 0.0;
      const double r = on_cap ? shape.radius * (1.0 + p.y()) : shape.radius;
      const double z = on_cap ? std::copysign(1.0, p.z()) : p.z();
      return Vector3d(r * std::cos(angle), r * std::sin(angle), 0.5 * shape.length * z);
    }
  }
}

class Primitives : public testing::TestWithParam<Shape> {};

TEST_P(Primitives, DistanceIsExact) {
  const Shape shape = GetParam();
  const auto field = makeSignedDistance(shape, 0.1);
  Random random(1);
  std::vector<Vector3d> surface;
  for (int i = 0; i < 2000; ++i) surface.push_back(surfacePoint(shape, random));
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = random.inCube(1.5);
    const DistanceSample sample = field->sample(p);
    EXPECT_DOUBLE_EQ(field->distance(p), sample.distance);
    EXPECT_EQ(sample.distance <= 0.0, isInside(shape, p));
    EXPECT_NEAR(sample.gradient.norm(), 1.0, 1e-14);
    const Vector3d foot = p - sample.distance * sample.gradient;
    EXPECT_NEAR(field->distance(foot), 0.0, 1e-14);
    for (const Vector3d& q : surface) EXPECT_GE((p - q).norm(), std::abs(sample.distance) - 1e-14);
  }
  for (const Vector3d& q : surface) EXPECT_NEAR(field->distance(q), 0.0, 1e-14);
}

TEST_P(Primitives, DegeneratePointsHaveUnitGradient) {
  const auto field = makeSignedDistance(GetParam(), 0.1);
  const double r = GetParam().kind == Shape::Kind::kBox ? 0.5 * GetParam().box_size.x() : GetParam().radius;
  const double z = GetParam().kind == Shape::Kind::kBox ? 0.5 * GetParam().box_size.z() : 0.5 * GetParam().length;
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(0, 0, z), Vector3d(0, 0, 2 * z), Vector3d(r, 0, z),
                            Vector3d(r, r, z), Vector3d(1e-200, 0, 0), Vector3d(r + 1e-200, 0, 0)}) {
    const DistanceSample sample = field->sample(p);
    EXPECT_TRUE(std::isfinite(sample.distance));
    EXPECT_NEAR(sample.gradient.norm(), 1.0, 1e-14) << p.transpose();
    EXPECT_NEAR(field->distance(p - sample.distance * sample.gradient), 0.0, 1e-14) << p.transpose();
  }
}

TEST_P(Primitives, VolumeAgreesWithCounting) {
  const Shape shape = GetParam();
  Random random(2);
  const AlignedBox3d box = bounds(shape, Isometry3d::Identity());
  int inside = 0;
  const int samples = 200000;
  for (int i = 0; i < samples; ++i) {
    inside += isInside(shape, box.center() + random.inCube(0.5).cwiseProduct(box.sizes()));
  }
  EXPECT_NEAR(volume(shape), box.volume() * inside / samples, 0.01 * box.volume());
}

TEST_P(Primitives, BoundsAreTightInAnyPose) {
  Random random(3);
  for (int pose = 0; pose < 20; ++pose) {
    Shape shape = GetParam();
    shape.X_BG = random.pose(1.0);
    const Isometry3d X_AB = random.pose(1.0);
    const AlignedBox3d box = bounds(shape, X_AB);
    AlignedBox3d points;
    for (int i = 0; i < 20000; ++i) points.extend(X_AB * shape.X_BG * surfacePoint(shape, random));
    const AlignedBox3d slack(box.min().array() - 1e-12, box.max().array() + 1e-12);
    EXPECT_TRUE(slack.contains(points));
    EXPECT_LT((box.sizes() - points.sizes()).maxCoeff(), 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Shape, Primitives,
                         testing::Values(box(0.8, 1.2, 0.5), box(0.02, 1.0, 1.0), sphere(0.7), cylinder(0.5, 1.4),
                                         cylinder(0.9, 0.1)));

TEST(ShapeUnion, IsTheMinimumInTheBodyFrameAndNoLessDeepInside) {
  Random random(4);
  std::vector<Shape> shapes = {box(0.4, 0.3, 0.2), sphere(0.2), cylinder(0.1, 0.5)};
  for (Shape& shape : shapes) shape.X_BG = random.pose(0.4);
  const auto field = makeSignedDistance(shapes, 0.05);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = random.inCube(1.0);
    double least = 1e9;
    Vector3d gradient = Vector3d::Zero();
    for (const Shape& shape : shapes) {
      const DistanceSample part = makeSignedDistance(shape, 0.05)->sample(shape.X_BG.inverse() * p);
      if (part.distance < least) gradient = shape.X_BG.linear() * part.gradient;
      least = std::min(least, part.distance);
    }
    const DistanceSample sample = field->sample(p);
    EXPECT_NEAR(field->distance(p), sample.distance, 1e-14);
    if (least > 0.0) {
      EXPECT_NEAR(sample.distance, least, 1e-14);
      EXPECT_LT((sample.gradient - gradient).norm(), 1e-12);
    } else {
      EXPECT_LE(sample.distance, least + 1e-14);
    }
    EXPECT_LE(field->bounds().exteriorDistance(p), std::max(least, 0.0) + 1e-14);
  }
}

TEST(ShapeUnion, DisplacesWhatItsPartsDoUnlessTheyMayOverlap) {
  Shape box;
  box.box_size = {2.0, 1.0, 1.0};
  Shape ball;
  ball.kind = Shape::Kind::kSphere;
  ball.radius = 0.5;
  ball.X_BG.translation() = Eigen::Vector3d(1.5, 0.0, 0.0);  // touches it
  const double part = M_PI / 6.0;
  const std::optional<Displacement> both = displacement({box, ball});
  ASSERT_TRUE(both.has_value());
  EXPECT_NEAR(both->volume, 2.0 + part, 1e-12);
  EXPECT_NEAR(both->centre[0], 1.5 * part / (2.0 + part), 1e-12);
  EXPECT_NEAR(both->centre.tail<2>().norm(), 0.0, 1e-12);
  ball.X_BG.translation()[0] = 1.4;
  EXPECT_FALSE(displacement({box, ball}).has_value());
}

TEST(ShapeUnion, NeedsAShape) { EXPECT_THROW(makeSignedDistance(std::vector<Shape>(), 0.1), std::invalid_argument); }

}  // namespace
}  // namespace monolith
