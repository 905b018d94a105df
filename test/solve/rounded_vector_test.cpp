#include "solve/rounded_vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace monolith {
namespace {

constexpr std::ptrdiff_t kGroup = 32;

struct Kept {
  // Parts that are no multiples of groups, a gap between them, and a rest.
  Parts parts{{3, 80}, {100, 101}, {101, 300}, {310, 317}};
  std::ptrdiff_t rest = 310;
  std::vector<float> x = std::vector<float>(317, 0.0F);
  Kept() {
    std::mt19937 random(3);
    std::normal_distribution<float> gauss;
    // Of all sizes, and smooth ones.
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = i < 150 ? gauss(random) * std::pow(10.0F, static_cast<float>(i % 7) - 3.0F) : 2.0F + gauss(random);
    }
  }
};

TEST(RoundedVector, KeepsEntriesToTheScaleOfTheirGroup) {
  Kept k;
  const std::vector<float> before = k.x;
  RoundedVector().take(k.parts, k.rest, k.x);
  for (const Part& part : k.parts) {
    for (auto begin = part.begin; begin < part.end; begin += kGroup) {
      const auto end = std::min(begin + kGroup, part.end);
      float most = 0.0F;
      for (auto i = begin; i < end; ++i) most = std::max(most, std::abs(before[i]));
      for (auto i = begin; i < end; ++i) {
        EXPECT_NEAR(k.x[i], before[i], part.begin < k.rest ? 1.6e-5 * most : 0.0) << i;
      }
    }
  }
  // Between the parts nothing is touched.
  for (const std::ptrdiff_t i : {0, 2, 80, 99, 305}) EXPECT_EQ(k.x[i], before[i]);
}

TEST(RoundedVector, EveryoneSeesTheSame) {
  Kept k;
  RoundedVector kept;
  kept.take(k.parts, k.rest, k.x);
  std::vector<double> sum(k.x.size(), 0.0);
  for (std::size_t p = 0; p < k.parts.size(); ++p) kept.addTo(k.parts, p, 1.0, sum.data() + k.parts[p].begin);
  for (const Part& part : k.parts) {
    for (auto i = part.begin; i < part.end; ++i) EXPECT_EQ(sum[i], static_cast<double>(k.x[i])) << i;
  }
  // Once more changes nothing but the last bit.
  std::vector<float> again = k.x;
  kept.take(k.parts, k.rest, again);
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_NEAR(again[i], k.x[i], 2e-7 * std::abs(k.x[i])) << i;
}

TEST(RoundedVector, WhatIsNoNumberIsTold) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Kept k;
    k.x[120] = wrong;
    RoundedVector().take(k.parts, k.rest, k.x);
    EXPECT_FALSE(std::isfinite(k.x[120]));
    EXPECT_TRUE(std::isfinite(k.x[200]));
  }
  Kept none;
  std::fill(none.x.begin(), none.x.end(), 1e-35F);
  RoundedVector().take(none.parts, none.rest, none.x);
  EXPECT_EQ(none.x[10], 0.0F);
}

}  // namespace
}  // namespace monolith
