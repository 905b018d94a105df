// Wall time against simulated time, and which steps are published.

#include "node/pacing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "node/publish_gate.h"

namespace monolith {
namespace {

TEST(RealTimePacer, DoesNotDrift) {
  RealTimePacer pacer;
  double wall = 100.0;
  pacer.restart(wall, 5.0);
  for (int step = 1; step <= 10000; ++step) {
    wall += 0.004;  // the step itself
    const double simulated = 5.0 + 0.02 * step;
    wall += std::max(pacer.remaining(wall, simulated), 0.0) + 0.0003;  // sleeping is never exact
  }
  EXPECT_NEAR(wall, 100.0 + 200.0, 0.01);
}

TEST(RealTimePacer, CatchesUpAfterAShortDelayOnly) {
  RealTimePacer pacer;
  pacer.restart(0.0, 0.0);
  EXPECT_NEAR(pacer.remaining(0.2, 0.1), -0.1, 1e-12);
  EXPECT_NEAR(pacer.remaining(0.2, 0.3), 0.1, 1e-12);
  // Ten seconds late: from here on no more than the longest catch-up is made good.
  pacer.remaining(10.0, 0.0);
  EXPECT_NEAR(pacer.remaining(10.0, RealTimePacer::kLongestCatchUpSec), 0.0, 1e-12);
}

TEST(RealTimeFactor, IsThatOfTheLastSecond) {
  RealTimeFactor factor;
  EXPECT_EQ(factor.value(), 0.0);
  for (int i = 0; i <= 100; ++i) factor.add(0.1 * i, 0.05 * i);
  EXPECT_NEAR(factor.value(), 0.5, 1e-9);
  for (int i = 1; i <= 12; ++i) factor.add(10.0 + 0.1 * i, 5.0 + 0.2 * i);
  EXPECT_NEAR(factor.value(), 2.0, 1e-9);
  // A step longer than the window.
  factor.add(20.0, 7.6);
  EXPECT_GT(factor.value(), 0.0);
  EXPECT_LT(factor.value(), 0.1);
  factor.restart();
  EXPECT_EQ(factor.value(), 0.0);
}

TEST(PublishGate, MeanRateIsExact) {
  for (const double rate : {1.0, 3.0, 7.5, 10.0, 24.0, 30.0, 49.0, 50.0}) {
    const PublishGate gate(rate, 0.02);
    int count = 0, longest = 0, since = 0;
    for (int step = 1; step <= 50 * 60; ++step) {
      ++since;
      if (!gate.isDue(step)) continue;
      longest = std::max(longest, since);
      since = 0;
      ++count;
    }
    EXPECT_EQ(count, std::lround(60.0 * rate)) << rate;
    EXPECT_LE(longest, std::ceil(50.0 / rate)) << rate;
  }
}

TEST(PublishGate, EveryStepAtMostAndTheInitialStateAlways) {
  const PublishGate fast(1000.0, 0.02), slow(0.1, 0.02);
  for (int step = 0; step < 20; ++step) EXPECT_TRUE(fast.isDue(step));
  // The number of its periods soon is too large for a number.
  const PublishGate absurd(1e308, 0.02);
  for (int step = 0; step < 1000; ++step) EXPECT_TRUE(absurd.isDue(step)) << step;
  EXPECT_TRUE(slow.isDue(0));
  EXPECT_FALSE(slow.isDue(1));
}

}  // namespace
}  // namespace monolith
