// A solid cut into parts is the solid it was cut from: what the parts have in common is not seen.

#include "geometry/union_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/mesh_samples.h"
#include "geometry/shape.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kResolution = 0.05;
constexpr double kReach = 5.0 * kResolution;
constexpr double kTolerance = 2e-3 * kResolution;  // parts that are this far apart may touch

Shape boxBetween(const Vector3d& low, const Vector3d& high) {
  Shape box;
  box.kind = Shape::Kind::kBox;
  box.box_size = high - low;
  box.X_BG.translation() = 0.5 * (low + high);
  return box;
}

Shape cylinderBetween(double radius, double low, double high) {
  Shape cylinder;
  cylinder.kind = Shape::Kind::kCylinder;
  cylinder.radius = radius;
  cylinder.length = high - low;
  cylinder.X_BG.translation() = Vector3d(0.0, 0.0, 0.5 * (low + high));
  return cylinder;
}

std::vector<Shape> placed(std::vector<Shape> shapes, const Isometry3d& X) {
  for (Shape& shape : shapes) shape.X_BG = X * shape.X_BG;
  return shapes;
}

const Isometry3d kAskew =
    Eigen::Translation3d(0.1, -0.2, 0.05) * Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -1.5).normalized());

class Random {
 public:
  Vector3d in(const AlignedBox3d& box) {
    Vector3d p;
    for (int a = 0; a < 3; ++a) p[a] = std::uniform_real_distribution<double>(box.min()[a], box.max()[a])(engine_);
    return p;
  }

 private:
  std::mt19937 engine_{7};
};

// Points of `zone`, a box in the frame X: distance, sign and gradient as `expected` has them, which is given in X.
template <class Distance>
void expectDistance(const SignedDistance& field, const Isometry3d& X, const AlignedBox3d& zone, Distance&& expected,
                    double tolerance) {
  Random random;
  int inside = 0, near = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d p = random.in(zone);
    const double right = expected(p);
    const DistanceSample sample = field.sample(X * p);
    ASSERT_NEAR(field.distance(X * p), sample.distance, 1e-14);
    ASSERT_NEAR(sample.gradient.norm(), 1.0, 1e-12);
    if (std::abs(right) > tolerance) ASSERT_EQ(sample.distance < 0.0, right < 0.0) << p.transpose();
    inside += right < 0.0;
    if (right < -kReach) {
      ASSERT_LE(sample.distance, -kReach + tolerance) << p.transpose();
      continue;
    }
    ++near;
    ASSERT_NEAR(sample.distance, right, tolerance) << p.transpose();
    if (right > kTolerance || right < -kReach + tolerance) continue;
    // The foot is on the surface.
    const Vector3d foot = p - sample.distance * (X.linear().transpose() * sample.gradient);
    ASSERT_NEAR(expected(foot), 0.0, 3.0 * tolerance) << p.transpose();
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(near, 1000);
}

double boxDistance(const Vector3d& low, const Vector3d& high, const Vector3d& p) {
  const Vector3d excess = (low - p).cwiseMax(p - high);
  return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
}

TEST(UnionDistance, OfABarCutInTwoIsThatOfTheBar) {
  const Vector3d low(-1.0, -0.3, -0.2), high(1.0, 0.3, 0.2);
  const auto bar = [&](const Vector3d& p) { return boxDistance(low, high, p); };
  const AlignedBox3d zone(Vector3d(-0.5, -0.5, -0.4), Vector3d(0.5, 0.5, 0.4));
  // They touch, are apart by what round-off leaves, or overlap.
  for (const double apart : {0.0, 1e-6, -1e-7, -0.02, -0.4}) {
    const std::vector<Shape> halves = {boxBetween(low, Vector3d(-0.5 * apart, 0.3, 0.2)),
                                       boxBetween(Vector3d(0.5 * apart, -0.3, -0.2), high)};
    for (const Isometry3d& X : {Isometry3d::Identity(), kAskew}) {
      SCOPED_TRACE(apart);
      expectDistance(*makeSignedDistance(placed(halves, X), kResolution), X, zone, bar, kTolerance);
    }
  }
}

TEST(UnionDistance, OfABarCutInManySlicesIsThatOfTheBar) {
  const Vector3d low(-0.15, -0.3, -0.2), high(0.15, 0.3, 0.2);
  std::vector<Shape> slices;
  for (int i = 0; i < 6; ++i) {
    slices.push_back(boxBetween(Vector3d(-0.15 + 0.05 * i, -0.3, -0.2), Vector3d(-0.1 + 0.05 * i, 0.3, 0.2)));
  }
  const AlignedBox3d zone(Vector3d(-0.3, -0.5, -0.4), Vector3d(0.3, 0.5, 0.4));
  expectDistance(
      *makeSignedDistance(placed(slices, kAskew), kResolution), kAskew, zone,
      [&](const Vector3d& p) { return boxDistance(low, high, p); }, kTolerance);
}

TEST(UnionDistance, IsExactOnTheSurfaceWhereASeamEnds) {
  const auto bar = makeSignedDistance({boxBetween(Vector3d(-1.0, -0.3, -0.2), Vector3d(0.0, 0.3, 0.2)),
                                       boxBetween(Vector3d(0.0, -0.3, -0.2), Vector3d(1.0, 0.3, 0.2))},
                                      kResolution);
  for (const double along : {-1e-3, -1e-6, 0.0, 1e-12, 1e-4}) {
    for (const double beyond : {-0.04, -1e-3, -1e-5, 0.0, 1e-5, 1e-3, 0.1}) {
      const DistanceSample sample = bar->sample(Vector3d(along, 0.1, 0.2 + beyond));
      EXPECT_NEAR(sample.distance, beyond, 1e-12) << along;
      EXPECT_LT((sample.gradient - Vector3d::UnitZ()).norm(), 1e-8) << along << " " << beyond;
    }
  }
}

// The space beside an L or a T is a quadrant: the depth below its edge is the distance to the edge.
double depthBelowStep(double x, double z) { return -std::hypot(std::min(x, 0.0), std::min(z, 0.0)); }

TEST(UnionDistance, BelowTheInnerEdgeOfAnLIsThatToTheEdge) {
  // Two walls as of a bucket: the floor (z < 0) and a wall on it (x < 0), or beside it.
  const Vector3d low(-1.0, -1.0, -1.0);
  const std::vector<std::vector<Shape>> cuts = {
      {boxBetween(low, {1.0, 1.0, 0.0}), boxBetween({-1.0, -1.0, 0.0}, {0.0, 1.0, 1.0})},
      {boxBetween({0.0, -1.0, -1.0}, {1.0, 1.0, 0.0}), boxBetween(low, {0.0, 1.0, 1.0})},
      {boxBetween(low, {1.0, 1.0, 0.0}), boxBetween(low, {0.0, 1.0, 1.0})}};
  const auto expected = [](const Vector3d& p) {
    const double x = p[0], z = p[2];
    return x > 0.0 && z > 0.0 ? std::min(x, z) : depthBelowStep(x, z);
  };
  const AlignedBox3d zone(Vector3d::Constant(-0.4), Vector3d::Constant(0.4));
  for (const std::vector<Shape>& cut : cuts) {
    expectDistance(*makeSignedDistance(placed(cut, kAskew), kResolution), kAskew, zone, expected, kTolerance);
  }
}

TEST(UnionDistance, BelowTheInnerCornerOfABucketIsThatToTheCorner) {
  const std::vector<Shape> corner = {boxBetween({-1.0, -1.0, -1.0}, {1.0, 1.0, 0.0}),
                                     boxBetween({-1.0, -1.0, 0.0}, {0.0, 1.0, 1.0}),
                                     boxBetween({0.0, -1.0, 0.0}, {1.0, 0.0, 1.0})};
  const auto expected = [](const Vector3d& p) { return p.minCoeff() > 0.0 ? p.minCoeff() : -p.cwiseMin(0.0).norm(); };
  const AlignedBox3d zone(Vector3d::Constant(-0.4), Vector3d::Constant(0.4));
  expectDistance(*makeSignedDistance(placed(corner, kAskew), kResolution), kAskew, zone, expected, kTolerance);
}

TEST(UnionDistance, OfAColumnOnAPlateKnowsNoFoot) {
  // The plate is below z = 0; the column stands on it, or goes through it.
  const double radius = 0.5;
  const auto expected = [&](const Vector3d& p) {
    const double beside = p.head<2>().norm() - radius;
    return beside > 0.0 && p[2] > 0.0 ? std::min(beside, p[2]) : depthBelowStep(beside, p[2]);
  };
  const AlignedBox3d zone(Vector3d(-0.8, -0.8, -0.4), Vector3d(0.8, 0.8, 0.4));
  for (const double foot : {0.0, -0.1}) {
    const std::vector<Shape> shapes = {boxBetween({-2.0, -2.0, -1.0}, {2.0, 2.0, 0.0}),
                                       cylinderBetween(radius, foot, 1.0)};
    expectDistance(*makeSignedDistance(placed(shapes, kAskew), kResolution), kAskew, zone, expected, kTolerance);
  }
}

TEST(UnionDistance, OfMeshesThatTouchKnowsNoSeam) {
  const Vector3d low(-1.0, -0.3, -0.2), high(1.0, 0.3, 0.2);
  std::vector<Shape> halves(2);
  for (int side = 0; side < 2; ++side) {
    halves[side].kind = Shape::Kind::kMesh;
    halves[side].mesh = std::make_shared<TriangleMesh>(cuboid({1.0, 0.6, 0.4}, {side - 0.5, 0.0, 0.0}));
  }
  // Next to an edge of a part, baked distances are right up to about their spacing.
  expectDistance(
      *makeSignedDistance(placed(halves, kAskew), kResolution), kAskew,
      AlignedBox3d(Vector3d(-0.5, -0.28, -0.18), Vector3d(0.5, 0.28, 0.18)),
      [&](const Vector3d& p) { return boxDistance(low, high, p); }, 0.6 * kResolution);
}

}  // namespace
}  // namespace monolith
