// The baked distance of a mesh against exact distances: of the cuboid by the box, of the torus by its formula.

#include "geometry/mesh_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

#include "geometry/shape_distance.h"
#include "mesh_samples.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> randomPoints(int count, double half) {
  std::mt19937 engine(5);
  const auto uniform = [&] { return half * (engine() / 2147483648.0 - 1.0); };
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(), y = uniform(), z = uniform();
    points.emplace_back(x, y, z);
  }
  return points;
}

double torusDistance(const Vector3d& p, double ring, double tube) {
  return std::hypot(p.head<2>().norm() - ring, p.z()) - tube;
}

TEST(MeshDistance, CuboidMatchesTheBox) {
  const Vector3d size(0.10, 0.08, 0.06);
  const auto exact = makeBoxDistance(size);
  for (const double resolution : {0.01, 0.005}) {
    const auto field = makeMeshDistance(cuboid(size, Vector3d::Zero()), resolution);
    for (const Vector3d& p : randomPoints(20000, 0.12)) {
      const DistanceSample sample = field->sample(p);
      const double truth = exact->distance(p);
      EXPECT_EQ(field->distance(p), sample.distance);
      EXPECT_NEAR(sample.gradient.norm(), 1.0, 1e-12);
      // Edges are rounded by the interpolation, everything else is linear.
      EXPECT_NEAR(sample.distance, truth, 0.3 * resolution);
      if (std::abs(truth) > 0.3 * resolution) {
        EXPECT_EQ(sample.distance < 0.0, truth < 0.0) << p.transpose();
      }
    }
  }
}

TEST(MeshDistance, FlatFacesAreExactAwayFromEdges) {
  const Vector3d size(0.10, 0.08, 0.06);
  const auto field = makeMeshDistance(cuboid(size, Vector3d(0.013, 0.0, 0.002)), 0.005);
  for (double gap = -0.015; gap <= 0.02; gap += 0.0013) {
    const DistanceSample sample = field->sample(Vector3d(0.013 + 0.007, -0.003, 0.002 + 0.03 + gap));
    EXPECT_NEAR(sample.distance, gap, 1e-7);
    EXPECT_LT((sample.gradient - Vector3d::UnitZ()).norm(), 1e-5);
  }
}

TEST(MeshDistance, TorusConvergesWithSecondOrder) {
  const double ring = 0.03, tube = 0.015;
  const TriangleMesh mesh = torus(ring, tube, 400, 200);
  double errors[2];
  const double resolutions[2] = {0.003, 0.0015};
  for (int i = 0; i < 2; ++i) {
    const auto field = makeMeshDistance(mesh, resolutions[i]);
    double sum = 0.0;
    int count = 0;
    for (const Vector3d& p : randomPoints(20000, 0.05)) {
      const double truth = torusDistance(p, ring, tube);
      if (std::abs(truth) > 0.003) continue;
      sum += std::pow(field->distance(p) - truth, 2);
      ++count;
    }
    errors[i] = std::sqrt(sum / count);
  }
  EXPECT_LT(errors[0], 0.03 * resolutions[0]);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.6);
}

TEST(MeshDistance, RightUpToThreeResolutionsAndALowerBoundBeyond) {
  const double ring = 0.03, tube = 0.015;
  const TriangleMesh mesh = torus(ring, tube, 200, 80);
  for (const double resolution : {0.01, 0.005, 0.002}) {
    const auto field = makeMeshDistance(mesh, resolution);
    const double slack = 0.1 * resolution;
    for (const Vector3d& p : randomPoints(20000, 0.3)) {
      const double truth = torusDistance(p, ring, tube);
      const double baked = field->distance(p);
      EXPECT_LE(std::abs(baked), std::abs(truth) + slack);
      EXPECT_EQ(baked < 0.0, truth < 0.0) << truth;
      if (truth < 3.0 * resolution) {
        EXPECT_NEAR(baked, truth, slack + 1e-4) << p.transpose();
      }
      EXPECT_GE(baked, field->bounds().exteriorDistance(p) - (truth < 0.0 ? 1.0 : 0.0) - 1e-12);
    }
  }
}

TEST(MeshDistance, GrowsOutwardsAndIsContinuousAcrossTheEndOfTheBand) {
  const auto field = makeMeshDistance(torus(0.03, 0.015, 64, 32), 0.005);
  std::vector<Vector3d> directions = randomPoints(200, 1.0);
  for (Vector3d& direction : directions) {
    direction.normalize();
    const double step = 2e-4;
    double previous = field->distance(0.06 * direction);
    for (double r = 0.06 + step; r < 0.3; r += step) {
      const double value = field->distance(r * direction);
      EXPECT_LE(std::abs(value - previous), 1.2 * step);
      EXPECT_GE(value, previous - 1e-6) << r;
      previous = value;
    }
  }
}

TEST(MeshDistance, GradientIsThatOfTheInterpolant) {
  const auto field = makeMeshDistance(torus(0.03, 0.015, 64, 32), 0.004);
  int checked = 0;
  for (const Vector3d& p : randomPoints(4000, 0.25)) {
    const DistanceSample sample = field->sample(p);
    Vector3d slope;
    const double step = 1e-7;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d shift = step * Vector3d::Unit(axis);
      slope[axis] = (field->distance(p + shift) - field->distance(p - shift)) / (2.0 * step);
    }
    if (slope.norm() < 0.1) continue;  // the medial surface
    const double error = (sample.gradient - slope.normalized()).norm();
    checked += error < 1e-4;
    // Where the difference straddles two cells the gradient jumps.
    EXPECT_TRUE(error < 1e-4 || error < 0.8) << p.transpose() << " " << error;
  }
  EXPECT_GT(checked, 3900);
}

TEST(MeshDistance, ThinPlateIsResolvedWhateverTheResolution) {
  const Vector3d size(0.10, 0.10, 0.004);
  const auto field = makeMeshDistance(cuboid(size, Vector3d::Zero()), 0.02);
  EXPECT_NEAR(field->distance(Vector3d(0.01, 0.02, 0.0)), -0.002, 1e-4);
  EXPECT_NEAR(field->distance(Vector3d(0.01, 0.02, 0.01)), 0.008, 1e-4);
}

TEST(MeshDistance, BakingIsDeterministicAndSamplingThreadSafe) {
  const TriangleMesh mesh = torus(0.03, 0.015, 64, 32);
  const auto first = makeMeshDistance(mesh, 0.004);
  const auto second = makeMeshDistance(mesh, 0.004);
  const std::vector<Vector3d> points = randomPoints(20000, 0.08);
  std::vector<double> values[2];
  const auto sampleAll = [&](int i) {
    for (const Vector3d& p : points) values[i].push_back((i == 0 ? first : second)->distance(p));
  };
  std::thread other(sampleAll, 0);
  sampleAll(1);
  other.join();
  EXPECT_EQ(values[0], values[1]);
}

TEST(MeshDistance, RefusesAResolutionThatIsNoLength) {
  const TriangleMesh mesh = cuboid(Vector3d::Ones(), Vector3d::Zero());
  for (const double resolution : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(makeMeshDistance(mesh, resolution), std::invalid_argument);
  }
}

}  // namespace
}  // namespace monolith
