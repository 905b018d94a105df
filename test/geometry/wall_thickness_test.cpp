#include "geometry/wall_thickness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/shape.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

Shape boxShape(const Vector3d& size, const Vector3d& position = Vector3d::Zero()) {
  Shape shape;
  shape.box_size = size;
  shape.X_BG = Eigen::Isometry3d(Eigen::Translation3d(position));
  return shape;
}

TEST(WallThickness, OfABallIsItsDiameterEverywhere) {
  Shape ball;
  ball.kind = Shape::Kind::kSphere;
  ball.radius = 0.05;
  const auto all = wallThickness(*makeSignedDistance(ball, 0.01), 0.01, 1.0);
  ASSERT_GT(all.size(), 100U);
  // So many samples of the surface as there is of it, whichever way it faces.
  EXPECT_NEAR(static_cast<double>(all.size()), 4.0 * M_PI * 25.0, 0.2 * 4.0 * M_PI * 25.0);
  for (const double thickness : all) EXPECT_NEAR(thickness, 0.1, 6e-4);
}

TEST(WallThickness, OfAPlateIsThatBetweenItsLargeFaces) {
  const auto all = wallThickness(*makeSignedDistance(boxShape({0.2, 0.3, 0.013}), 0.01), 0.01, 1.0);
  ASSERT_FALSE(all.empty());
  EXPECT_NEAR(all.front(), 0.013, 5e-4);
  EXPECT_NEAR(all[all.size() / 2], 0.013, 5e-4);
}

TEST(WallThickness, NoMoreIsLookedForThanIsAskedFor) {
  const auto all = wallThickness(*makeSignedDistance(boxShape({0.2, 0.2, 0.2}), 0.01), 0.01, 0.05);
  ASSERT_FALSE(all.empty());
  for (const double thickness : all) EXPECT_EQ(thickness, 0.05);
}

// Two walls that meet at a corner, of two boxes.
TEST(WallThickness, TouchingPartsAreOneSolid) {
  const auto corner = makeSignedDistance(
      std::vector<Shape>{boxShape({0.2, 0.2, 0.02}), boxShape({0.02, 0.2, 0.2}, {0.09, 0.0, 0.11})}, 0.01);
  const auto all = wallThickness(*corner, 0.01, 1.0);
  EXPECT_NEAR(all.front(), 0.02, 1e-3) << "a seam is no surface";
  EXPECT_TRUE(isThinner(*corner, {0.0, 0.0, 0.008}, 0.03));
  EXPECT_FALSE(isThinner(*corner, {0.0, 0.0, 0.008}, 0.015));
  // Where the wall stands on the floor there is more behind the floor's lower face.
  EXPECT_FALSE(isThinner(*corner, {0.09, 0.0, -0.008}, 0.03));
}

}  // namespace
}  // namespace monolith
