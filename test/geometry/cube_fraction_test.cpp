#include "geometry/cube_fraction.h"

#include <gtest/gtest.h>

#include <random>

namespace monolith {
namespace {

// Part of the unit cube below the plane, by counting points of a fine grid.
double counted(double distance, const Eigen::Vector3d& normal) {
  constexpr int kSide = 60;
  int inside = 0;
  for (int k = 0; k < kSide; ++k) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const Eigen::Vector3d x =
            (Eigen::Vector3d(i, j, k) + Eigen::Vector3d::Constant(0.5)) / kSide - Eigen::Vector3d::Constant(0.5);
        inside += distance + normal.dot(x) < 0.0;
      }
    }
  }
  return inside / std::pow(kSide, 3);
}

TEST(CubeFraction, AgreesWithCountingForRandomPlanes) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> offset(-0.9, 0.9);
  for (int trial = 0; trial < 100; ++trial) {
    Eigen::Vector3d normal(gauss(random), gauss(random), gauss(random));
    if (trial % 4 == 1) normal[trial % 3] = 0.0;
    if (trial % 4 == 2) normal = Eigen::Vector3d::Unit(trial % 3);
    normal.normalize();
    const double distance = offset(random);
    EXPECT_NEAR(insideFraction(distance, normal, 1.0), counted(distance, normal), 0.012) << normal.transpose();
  }
}

TEST(CubeFraction, BothSidesOfAPlaneFillTheCube) {
  std::mt19937 random(4);
  std::normal_distribution<double> gauss;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d normal = Eigen::Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
    const double distance = 0.01 * gauss(random);
    EXPECT_NEAR(insideFraction(distance, normal, 0.02) + insideFraction(-distance, -normal, 0.02), 1.0, 1e-12);
  }
}

// To first order in a slope the part depends on the plane's height at the centre alone, however slight the slope is.
TEST(CubeFraction, NearlyParallelPlanesKeepTheirDigits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (double slight = 1e-3; slight > 1e-14; slight *= 0.3) {
    for (int trial = 0; trial < 20; ++trial) {
      const double height = 0.4 * unit(random);
      const Eigen::Vector3d along_an_axis(slight * unit(random), slight * unit(random), 1.0);
      EXPECT_NEAR(insideFraction(height / along_an_axis.norm(), along_an_axis, 1.0), 0.5 - height, 1e-12);
      // Half of the cube's diagonal plane: the part below a + b = alpha of the unit square is alpha^2/2.
      const double alpha = 0.5 + 0.4 * unit(random);
      const Eigen::Vector3d diagonal(1.0, 1.0, slight * unit(random));
      const double part = insideFraction((1.0 - alpha) / diagonal.norm(), diagonal, 1.0);
      EXPECT_NEAR(part, 0.5 * alpha * alpha, slight * slight + 1e-8);
    }
  }
}

TEST(CubeFraction, EightAtOnceAreAsOneByOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  constexpr double kWidth = 0.25;
  for (int trial = 0; trial < 1000; ++trial) {
    CutCubes cubes;
    std::array<double, CutCubes::kCount> expected{};
    for (int i = 0; i < CutCubes::kCount; ++i) {
      Eigen::Vector3d slope(unit(random), unit(random), unit(random));
      if (trial % 5 == 1) slope[trial % 3] = 0.0;
      const double distance = kWidth * unit(random);
      cubes.set(i, distance, slope);
      expected[i] = insideFraction(distance, slope, kWidth);
    }
    insideFractions(cubes, kWidth);
    for (int i = 0; i < CutCubes::kCount; ++i) EXPECT_NEAR(cubes.inside[i], expected[i], 1e-12);
  }
}

TEST(CubeFraction, FarPlanesAreAllOrNothing) {
  EXPECT_EQ(insideFraction(2.0, Eigen::Vector3d::UnitX(), 1.0), 0.0);
  EXPECT_EQ(insideFraction(-2.0, Eigen::Vector3d::UnitX(), 1.0), 1.0);
  EXPECT_EQ(insideFraction(-1e-3, Eigen::Vector3d::Zero(), 1.0), 1.0);
}

}  // namespace
}  // namespace monolith
