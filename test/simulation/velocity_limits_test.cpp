// What faces that hold little liquid pass on.

#include "simulation/velocity_limits.h"

#include <gtest/gtest.h>

namespace monolith {
namespace {

// A box of cells without solids, liquid up to a part of the faces along z in layer kTop; below all is liquid.
constexpr int kCells = 8, kTop = 5;
constexpr double kBodySpeed = 4.0;  // m/s

struct HalfFull {
  HalfFull() {
    grid.lattice = Lattice({kCells, kCells, kCells}, {false, false, false});
    grid.h = 0.02;
    for (int a = 0; a < 3; ++a) {
      mass[a].assign(grid.lattice.size, 0.0);
      known[a].assign(grid.lattice.size, 0);
      velocity[a].assign(grid.lattice.size, 0.0);
      solids.fluid[a].assign(grid.lattice.size, 1.0);
      solids.distance[a].assign(grid.lattice.size, 1.0F);
      solids.owner[a].assign(grid.lattice.size, SolidFractions::kWall);
    }
    forEach([&](int a, std::ptrdiff_t f, int k) {
      mass[a][f] = k < kTop ? 1.0 : a == 2 && k == kTop ? 0.1 : 0.0;
      known[a][f] = mass[a][f] > 0.0 ? 1 : 0;
    });
  }

  template <class Function>
  void forEach(Function&& f) const {
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < kCells; ++k) {
        for (int j = 0; j < kCells; ++j) {
          for (int i = 0; i < kCells; ++i) f(a, grid.lattice.index(i, j, k), k);
        }
      }
    }
  }

  void limit(double slack) { limitCutFaces(mass, solids, grid, {kBodySpeed}, slack, velocity, known); }

  MacGrid grid;
  SolidFractions solids;
  FaceField<double> mass, velocity;
  FaceMask known;
};

TEST(VelocityLimits, MotionThatGoesOnStraightStays) {
  HalfFull box;
  const Lattice& l = box.grid.lattice;
  // Turns about the y-axis as one.
  box.forEach([&](int a, std::ptrdiff_t f, int k) {
    if (!box.known[a][f]) return;
    const double x = l.cell(f)[0], z = k + (a == 2 ? 0.0 : 0.5);
    box.velocity[a][f] = a == 0 ? z : a == 2 ? -(x + 0.5) : 0.0;
  });
  const FaceField<double> before = box.velocity;
  box.limit(0.0);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(box.velocity[a], before[a]) << "axis " << a;
}

TEST(VelocityLimits, ACutFaceIsNoFasterThanWhatFlowsTowardsIt) {
  HalfFull box;
  const Lattice& l = box.grid.lattice;
  const auto jet = l.index(4, 4, kTop), side = l.index(4, 4, kTop - 1);
  box.velocity[2][jet] = 9.6;
  box.velocity[0][side] = 2.4;
  box.limit(0.1);
  EXPECT_DOUBLE_EQ(box.velocity[2][jet], 2.5);
  EXPECT_DOUBLE_EQ(box.velocity[0][side], 2.4);
}

TEST(VelocityLimits, WhatABodyDrivesMayBeAsFastAsTheBody) {
  HalfFull box;
  const auto jet = box.grid.lattice.index(4, 4, kTop);
  box.velocity[2][jet] = 9.6;
  box.solids.owner[2][jet] = 0;
  box.limit(0.0);
  EXPECT_DOUBLE_EQ(box.velocity[2][jet], kBodySpeed);
}

TEST(VelocityLimits, WhereNothingWholeIsNearNothingIsLimited) {
  HalfFull box;
  box.forEach([&](int a, std::ptrdiff_t f, int) { box.mass[a][f] *= 0.5; });
  const auto spray = box.grid.lattice.index(4, 4, kTop);
  box.velocity[2][spray] = -9.6;
  box.limit(0.0);
  EXPECT_DOUBLE_EQ(box.velocity[2][spray], -9.6);
}

}  // namespace
}  // namespace monolith
