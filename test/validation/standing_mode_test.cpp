// The reference of the sloshing case against boundary-layer theory, where that holds.

#include "physics/standing_mode.h"

#include <gtest/gtest.h>

#include <cmath>

namespace monolith {
namespace {

StandingTank tankOf(double viscosity, bool walls_hold) {
  StandingTank tank;
  tank.viscosity = viscosity;
  tank.walls_hold = walls_hold;
  return tank;
}

double excess(const StandingTank& tank) { return standingRate(tank).real() / boundaryLayerRate(tank).real() - 1.0; }

TEST(StandingMode, IsThatOfBoundaryLayerTheoryWithoutFrictionAtTheSideWalls) {
  for (const double viscosity : {1e-4, 1e-3}) {
    const StandingTank tank = tankOf(viscosity, false);
    EXPECT_NEAR(excess(tank), 0.0, 0.015) << viscosity;
    EXPECT_NEAR(standingRate(tank).imag(), boundaryLayerRate(tank).imag(), 2e-3) << viscosity;
  }
}

// What theory leaves out is of the order of the layers' thickness, with a logarithm.
TEST(StandingMode, CornersOfSurfaceAndWallsCountLessWhereLayersAreThinner) {
  const double thick = excess(tankOf(1e-3, true)), thin = excess(tankOf(1e-4, true)),
               thinner = excess(tankOf(1e-5, true));
  EXPECT_NEAR(thick, 0.29, 0.01);
  EXPECT_NEAR(thin, 0.18, 0.01);
  EXPECT_LT(thinner, 0.5 * thin);
  EXPECT_GT(thinner, 0.0);
}

TEST(StandingMode, FollowsTheScalesOfTheTank) {
  const StandingTank tank = tankOf(1e-3, true);
  StandingTank twice = tank;
  twice.length *= 2.0;
  twice.depth *= 2.0;
  twice.gravity *= 2.0;
  twice.viscosity *= 4.0;  // same rates: length^2/time
  EXPECT_NEAR(std::abs(standingRate(twice) / standingRate(tank) - 1.0), 0.0, 1e-6);
}

}  // namespace
}  // namespace monolith
