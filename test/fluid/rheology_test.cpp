// The laws of generalised Newtonian liquids against their definitions and limits.

#include "fluid/rheology.h"

#include <gtest/gtest.h>

#include <cmath>

namespace monolith {
namespace {

TEST(ViscosityLaw, NewtonianIsConstant) {
  const ViscosityLaw law = ViscosityLaw::newtonian(1.41);
  EXPECT_TRUE(law.constant());
  for (const double rate : {0.0, 1e-9, 1.0, 1e9}) EXPECT_EQ(law.viscosity(rate), 1.41);
}

TEST(ViscosityLaw, OfPowerLawHasItsSlopeBetweenTheLimits) {
  for (const double n : {0.3, 0.8, 1.0, 1.7}) {
    const ViscosityLaw law = ViscosityLaw::powerLaw(4.0, n, 1e-3, 1e3);
    EXPECT_NEAR(law.viscosity(1.0), 4.0, 1e-12);
    EXPECT_NEAR(law.viscosity(20.0) / law.viscosity(2.0), std::pow(10.0, n - 1.0), 1e-12);
  }
  const ViscosityLaw thinning = ViscosityLaw::powerLaw(4.0, 0.5, 1e-3, 1e3);
  EXPECT_EQ(thinning.viscosity(0.0), 1e3);
  EXPECT_EQ(thinning.viscosity(1e12), 1e-3);
  const ViscosityLaw thickening = ViscosityLaw::powerLaw(4.0, 2.0, 1e-3, 1e3);
  EXPECT_EQ(thickening.viscosity(0.0), 1e-3);
  EXPECT_EQ(thickening.viscosity(1e12), 1e3);
}

TEST(ViscosityLaw, OfCarreauYasudaGoesFromOnePlateauToTheOther) {
  const ViscosityLaw law = ViscosityLaw::carreauYasuda(10.0, 0.5, 2.0, 0.4, 2.0);
  EXPECT_EQ(law.viscosity(0.0), 10.0);
  EXPECT_NEAR(law.viscosity(1e12), 0.5, 1e-4);
  // lambda gamma = 1: (1 + 1)^((n-1)/a)
  EXPECT_NEAR(law.viscosity(0.5), 0.5 + 9.5 * std::pow(2.0, -0.3), 1e-12);
  // Far beyond, the power law.
  EXPECT_NEAR((law.viscosity(2e5) - 0.5) / (law.viscosity(2e4) - 0.5), std::pow(10.0, -0.6), 1e-6);
}

TEST(ViscosityLaw, OfHerschelBulkleyYields) {
  const double most = 3.0 + 500.0 * 20.0;
  const ViscosityLaw bingham = ViscosityLaw::herschelBulkley(20.0, 3.0, 1.0, 500.0, 3.0, most);
  EXPECT_NEAR(bingham.viscosity(0.0), most, 1e-9 * most);
  // Past yield the stress is tau_0 + K gamma.
  for (const double rate : {0.1, 1.0, 100.0}) EXPECT_NEAR(bingham.viscosity(rate) * rate, 20.0 + 3.0 * rate, 1e-9);
  // No jump where the series takes over from the exponential.
  EXPECT_NEAR(bingham.viscosity(1e-15), bingham.viscosity(1e-13), 1e-6 * most);
}

// Otherwise a step could have more than one solution.
TEST(ViscosityLaw, StressGrowsWithTheRate) {
  for (const ViscosityLaw& law :
       {ViscosityLaw::newtonian(2.0), ViscosityLaw::powerLaw(4.0, 0.2, 1e-3, 1e3),
        ViscosityLaw::powerLaw(0.1, 2.5, 1e-3, 1e3), ViscosityLaw::carreauYasuda(10.0, 0.0, 3.0, 0.1, 1.3),
        ViscosityLaw::herschelBulkley(20.0, 3.0, 0.4, 500.0, 1e-3, 1e5)}) {
    double before = 0.0;
    for (double rate = 1e-9; rate < 1e9; rate *= 1.3) {
      const double stress = law.viscosity(rate) * rate;
      EXPECT_GT(stress, before) << rate;
      // Never steeper than it says.
      if (before > 0.0) EXPECT_LT(std::log(stress / before) / std::log(1.3), law.steepest() + 1e-9) << rate;
      before = stress;
    }
    EXPECT_LE(law.least(), law.viscosity(1e12));
    EXPECT_GE(law.most(), law.viscosity(0.0));
  }
}

}  // namespace
}  // namespace monolith
