#include "solve/lattice.h"

#include <gtest/gtest.h>

#include "solve/staggered_operator.h"

namespace monolith {
namespace {

TEST(Lattice, PeriodicImagesStandForWhatIsInTheTank) {
  const Lattice l({4, 5, 6}, {true, false, false});
  for (const int image : {-8, -4, 0, 4, 8}) {
    EXPECT_EQ(l.wrapped(0, 3 + image), 3);
    EXPECT_EQ(l.indexInTank({3 + image, 2, 1}), l.index(3, 2, 1));
    EXPECT_EQ(l.indexInTank({3 + image, 2, 1}, {true, false, false}), l.index(3, 2, 1));
  }
  EXPECT_EQ(l.wrapped(1, -1), -1);
  EXPECT_EQ(l.wrapped(1, 7), 7);
}

TEST(Lattice, WhatLiesBeyondWallsHasNoIndex) {
  const Lattice l({4, 5, 6}, {true, false, false});
  EXPECT_EQ(l.indexInTank({0, -1, 0}), -1);
  EXPECT_EQ(l.indexInTank({0, 0, 6}), -1);
  EXPECT_EQ(l.indexInTank({0, 4, 5}), l.index(0, 4, 5));
  // There is one more face than cells, along its own axis.
  EXPECT_EQ(l.indexInTank({0, 5, 5}, {false, true, false}), l.index(0, 5, 5));
  EXPECT_EQ(l.indexInTank({0, 6, 5}, {false, true, false}), -1);
  EXPECT_EQ(l.indexInTank({0, 5, 6}, {false, true, false}), -1);
  EXPECT_EQ(l.indexInTank({0, -1, 5}, {false, true, false}), -1);
}

TEST(Lattice, EdgesEndAtWallsAcrossThem) {
  const Lattice l({4, 5, 6}, {false, false, false});
  const int pair = 1;  // x and z: edges along y
  EXPECT_EQ(edgeIndex(l, pair, {4, 4, 6}), l.index(4, 4, 6));
  EXPECT_EQ(edgeIndex(l, pair, {4, 5, 6}), -1);
  EXPECT_EQ(edgeIndex(l, pair, {5, 4, 6}), -1);
}

}  // namespace
}  // namespace monolith
