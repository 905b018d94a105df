#include "fluid/free_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

MacGrid cube(int n, double h) {
  MacGrid grid;
  grid.lattice = Lattice({n, n, n}, {false, false, false});
  grid.h = h;
  return grid;
}

TEST(FreeSurface, VolumeOfAFillIsExact) {
  const MacGrid grid = cube(12, 0.05);
  const std::vector<double> open(grid.lattice.size, 1.0);
  for (const double level : {0.1, 0.2345, 0.299999, 0.31}) {
    const FreeSurface surface(grid, level, {});
    EXPECT_NEAR(surface.volume(open), level * 0.36, 1e-9);
    EXPECT_FALSE(surface.full());
  }
  EXPECT_TRUE(FreeSurface(grid, 0.6, {}).full());
  EXPECT_TRUE(FreeSurface(grid, 0.0, {}).empty());
}

// Where liquid meets liquid there is no surface: boxes side by side, one in another, one on the fill are as one box.
TEST(FreeSurface, ASeamIsNoSurface) {
  const MacGrid grid = cube(12, 0.05);
  const std::vector<double> open(grid.lattice.size, 1.0);
  const auto box = [](double x0, double x1, double z0, double z1) {
    return Eigen::AlignedBox3d(Eigen::Vector3d(x0, 0.1, z0), Eigen::Vector3d(x1, 0.5, z1));
  };
  const FreeSurface one(grid, 0.0, {box(0.1, 0.5, 0.0, 0.42)});
  const std::vector<std::vector<Eigen::AlignedBox3d>> divisions = {
      {box(0.1, 0.31, 0.0, 0.42), box(0.31, 0.5, 0.0, 0.42)},
      {box(0.1, 0.5, 0.0, 0.2), box(0.1, 0.5, 0.2, 0.42)},
      {box(0.1, 0.5, 0.0, 0.42), box(0.2, 0.4, 0.1, 0.3)}};
  for (const auto& boxes : divisions) {
    const FreeSurface divided(grid, 0.0, boxes);
    EXPECT_NEAR(divided.volume(open), one.volume(open), 1e-9);
    for (std::size_t c = 0; c < grid.lattice.size; ++c) {
      if (one.distance()[c] > -6.0) EXPECT_NEAR(divided.distance()[c], one.distance()[c], 1e-9);
    }
  }
  const Eigen::AlignedBox3d upper(Eigen::Vector3d(0.0, 0.0, 0.225), Eigen::Vector3d(0.6, 0.6, 0.4));
  EXPECT_NEAR(FreeSurface(grid, 0.225, {upper}).volume(open), 0.4 * 0.36, 1e-9);
}

// Of cubes of liquid, wherever their faces lie between the grid's: edges and corners hold no more than there is.
TEST(FreeSurface, VolumeOfABoxIsThatOfTheBox) {
  const MacGrid grid = cube(20, 0.05);
  const std::vector<double> open(grid.lattice.size, 1.0);
  for (const double cells : {2.0, 2.5, 3.0, 4.0, 5.0, 7.5}) {
    for (const double offset : {0.0, 0.25, 0.5, 0.75, 0.9}) {
      const Eigen::Vector3d low = Eigen::Vector3d::Constant((5.0 + offset) * grid.h);
      const Eigen::Vector3d high = low + Eigen::Vector3d::Constant(cells * grid.h);
      const double volume = std::pow(cells * grid.h, 3);
      EXPECT_NEAR(FreeSurface(grid, 0.0, {{low, high}}).volume(open), volume, 0.01 * volume) << cells << ", " << offset;
      // On the floor and in a corner, on a pool, through its surface; an L, and two that overlap.
      const Eigen::Vector3d floor(low[0], low[1], 0.0), corner(0.0, 0.0, 0.0);
      EXPECT_NEAR(FreeSurface(grid, 0.0, {{floor, high}}).volume(open), (high - floor).prod(), 0.02 * volume);
      EXPECT_NEAR(FreeSurface(grid, 0.0, {{corner, high}}).volume(open), high.prod(), 0.02 * volume);
      EXPECT_NEAR(FreeSurface(grid, low[2], {{low, high}}).volume(open), low[2] + volume, 0.02 * volume);
      const double level = low[2] + 0.3 * grid.h;
      const double part = 1.0 - 0.3 / cells;
      EXPECT_NEAR(FreeSurface(grid, level, {{low, high}}).volume(open), level + part * volume, 0.02 * volume);
      const Eigen::Vector3d along = cells * grid.h * Eigen::Vector3d(0.5, 0.0, 0.0);
      const Eigen::Vector3d across = cells * grid.h * Eigen::Vector3d(0.0, 0.4, 0.4);
      EXPECT_NEAR(FreeSurface(grid, 0.0, {{low, high + along}, {low, high + across}}).volume(open),
                  (1.5 + 1.4 * 1.4 - 1.0) * volume, 0.02 * volume);
    }
  }
}

// As much as cells can hold: liquid that no cell has more than a part of is in one of them still.
TEST(FreeSurface, ABlobOfACellOrTwoStays) {
  const MacGrid grid = cube(12, 0.05);
  const std::vector<double> open(grid.lattice.size, 1.0);
  for (const double cells : {1.2, 1.5, 1.9}) {
    for (const double offset : {0.0, 0.25, 0.4, 0.5, 0.9}) {
      const Eigen::Vector3d low = Eigen::Vector3d::Constant((5.0 + offset) * grid.h);
      const double side = cells * grid.h, volume = side * side * side;
      const FreeSurface blob(grid, 0.0, {{low, low + Eigen::Vector3d::Constant(side)}});
      EXPECT_GT(std::count_if(blob.distance().begin(), blob.distance().end(), [](double d) { return d < 0.0; }), 0);
      EXPECT_NEAR(blob.volume(open), volume, 0.25 * volume) << cells << ", " << offset;
    }
  }
}

// As far as the liquid goes, also where that is further than the band in which the level set is a distance.
TEST(FreeSurface, LiquidMayCrossManyCellsAtOnce) {
  MacGrid grid;
  grid.lattice = Lattice({4, 4, 64}, {true, true, false});
  grid.h = 0.05;
  const std::vector<double> open(grid.lattice.size, 1.0);
  for (const double cells : {3.7, 8.3, 12.6, 25.0}) {
    FreeSurface surface(grid, 0.0,
                        {Eigen::AlignedBox3d(Eigen::Vector3d(0.0, 0.0, 2.0), Eigen::Vector3d(0.2, 0.2, 2.9))});
    FaceField<double> velocity;
    for (int a = 0; a < 3; ++a) velocity[a].assign(grid.lattice.size, a == 2 ? -1.0 : 0.0);
    surface.advect(velocity, cells * grid.h, 1.0, {});
    EXPECT_NEAR(surface.volume(open), 0.9 * 0.04, 1e-9) << cells;
    for (int k = 0; k < 64; ++k) {
      const double z = (k + 0.5) * grid.h + cells * grid.h;
      const double distance = std::max(2.0 - z, z - 2.9) / grid.h;
      const double found = surface.distance()[grid.lattice.index(1, 2, k)];
      if (std::abs(distance) < 4.0) EXPECT_NEAR(found, distance, 1e-6) << cells << " cells, " << k;
      if (std::abs(distance) >= 4.0) EXPECT_EQ(found < 0.0, distance < 0.0) << cells << " cells, " << k;
    }
  }
}

// Nonsense, but it ends.
TEST(FreeSurface, NoSpeedIsTooLarge) {
  const MacGrid grid = cube(12, 0.05);
  FreeSurface surface(grid, 0.31, {});
  FaceField<double> velocity;
  for (auto& field : velocity) field.assign(grid.lattice.size, 1e15);
  surface.advect(velocity, 1.0, 2e15, {});
  for (const double d : surface.distance()) ASSERT_TRUE(std::isfinite(d));
}

TEST(FreeSurface, CorrectionReachesTheTargetAndSaysByHowMuch) {
  const MacGrid grid = cube(12, 0.05);
  const std::vector<double> open(grid.lattice.size, 1.0);
  FreeSurface surface(grid, 0.25, {});
  const double added = surface.correctVolume(0.0901, open, {open, open, open});
  EXPECT_NEAR(surface.volume(open), 0.0901, 1e-9);
  EXPECT_NEAR(added, 0.0001, 1e-9);
}

// Two pools with a wall between them, a film in a chamber of that wall, and a drop above the left pool, whose liquid is
// made to grow.
TEST(FreeSurface, PoolsThatAreApartKeepTheirVolumes) {
  const MacGrid grid{Lattice({16, 8, 16}, {false, false, false}), 0.1, Eigen::Vector3d::Zero()};
  const Lattice& l = grid.lattice;
  std::vector<double> fluid(l.size, 1.0);
  FaceField<double> open{fluid, fluid, fluid}, velocity;
  for (auto& field : velocity) field.assign(l.size, 0.0);
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 6; i < 10; ++i) {
        const auto c = l.index(i, j, k);
        fluid[c] = 0.0;
        for (int a = 0; a < 3; ++a) open[a][c] = open[a][c + l.stride[a]] = 0.0;
      }
      for (int i = 7; i < 9; ++i) fluid[l.index(i, j, k)] = 1.0;
      for (int a = 0; a < 3; ++a) open[a][l.index(8, j, k)] = 1.0;
      for (int i = 0; i < 7; ++i) velocity[2][l.index(i, j, k)] = 0.1;
    }
  }
  const auto box = [](double x0, double x1, double z0, double z1) {
    return Eigen::AlignedBox3d(Eigen::Vector3d(x0, 0.0, z0), Eigen::Vector3d(x1, 0.8, z1));
  };
  FreeSurface surface(
      grid, 0.0,
      {box(0.0, 0.6, 0.0, 0.43), box(1.0, 1.6, 0.0, 0.72), box(0.1, 0.5, 0.9, 1.3), box(0.7, 0.9, 0.0, 0.07)});
  const double target = surface.volume(fluid);
  surface.correctVolume(target, fluid, open);
  const FreeSurface before = surface;
  surface.advect(velocity, 0.5, 0.1, {});
  EXPECT_GT(surface.volume(fluid), 1.03 * target);
  const FreeSurface grown = surface;
  surface.correctVolume(target, fluid, open);
  for (int correction = 0; correction < 10; ++correction) surface.correctVolume(target, fluid, open);
  EXPECT_NEAR(surface.volume(fluid), target, 1e-9 * target);
  const auto columnOf = [&](const FreeSurface& of, int i) { return of.distance()[l.index(i, 4, i < 6 ? 4 : 7)]; };
  EXPECT_NEAR(columnOf(surface, 12), columnOf(before, 12), 1e-9) << "the right pool is as it was";
  EXPECT_GT(columnOf(surface, 0), columnOf(grown, 0) + 0.2) << "the left one is lower again";
}

TEST(FreeSurface, ADropCarriedAcrossTheTankKeepsItsPlaceAndSize) {
  const int n = 32;
  const MacGrid grid = cube(n, 1.0 / n);
  const Lattice& l = grid.lattice;
  const std::vector<double> open(l.size, 1.0);
  FreeSurface surface(grid, 0.0, {Eigen::AlignedBox3d(Eigen::Vector3d(0.2, 0.3, 0.3), Eigen::Vector3d(0.5, 0.7, 0.7))});
  const double before = surface.volume(open);
  FaceField<double> velocity;
  for (int a = 0; a < 3; ++a) velocity[a].assign(l.size, a == 0 ? 0.5 : 0.0);
  for (int step = 0; step < 20; ++step) surface.advect(velocity, 0.03, 0.5, {});  // by 0.3
  EXPECT_NEAR(surface.volume(open) / before, 1.0, 0.05);
  double x = 0.0, mass = 0.0;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (surface.distance()[l.index(i, j, k)] >= 0.0) continue;
        x += grid.cellCenter(i, j, k)[0];
        mass += 1.0;
      }
    }
  }
  EXPECT_NEAR(x / mass, 0.65, 0.3 * grid.h);
}

TEST(FreeSurface, StaysADistanceWhileItMoves) {
  const int n = 24;
  const MacGrid grid = cube(n, 1.0 / n);
  const Lattice& l = grid.lattice;
  FreeSurface surface(grid, 0.5, {});
  // Shear that tilts the surface.
  FaceField<double> velocity;
  for (auto& field : velocity) field.assign(l.size, 0.0);
  for (int k = -1; k < n + 2; ++k) {
    for (int j = -1; j < n + 2; ++j) {
      for (int i = -1; i < n + 2; ++i) velocity[2][l.index(i, j, k)] = (i + 0.5) / n - 0.5;
    }
  }
  for (int step = 0; step < 10; ++step) surface.advect(velocity, 0.05, 0.5, {});
  int looked = 0;
  for (int k = 2; k < n - 2; ++k) {
    for (int i = 3; i < n - 3; ++i) {
      const auto c = l.index(i, n / 2, k);
      const double d = surface.distance()[c];
      if (std::abs(d) > 2.0) continue;
      // The plane z = 0.5 + 0.5 (x - 0.5), in cells.
      const double exact = (k + 0.5 - 0.5 * n - 0.5 * (i + 0.5 - 0.5 * n)) / std::sqrt(1.25);
      EXPECT_NEAR(d, exact, 0.1);
      ++looked;
    }
  }
  EXPECT_GT(looked, 30);
}

// Its distance once grew tenfold each time it was made a distance again, and the volume's correction with it.
TEST(FreeSurface, ABubbleOfOneCellDoesNotGrowAtRest) {
  const int n = 8;
  const MacGrid grid = cube(n, 1.0 / n);
  const std::vector<double> open(grid.lattice.size, 1.0);
  const Eigen::Vector3d low(3.0 / n, 4.0 / n, 2.0 / n), high = low + Eigen::Vector3d::Constant(1.0 / n);
  std::vector<Eigen::AlignedBox3d> around;
  for (int a = 0; a < 3; ++a) {
    Eigen::AlignedBox3d below(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()), above = below;
    below.max()[a] = low[a];
    above.min()[a] = high[a];
    around.push_back(below);
    around.push_back(above);
  }
  FreeSurface surface(grid, 0.0, around);
  const auto bubble = grid.lattice.index(3, 4, 2);
  ASSERT_GT(surface.distance()[bubble], 0.0);
  const double air = 1.0 - surface.volume(open);
  FaceField<double> velocity;
  for (auto& field : velocity) field.assign(grid.lattice.size, 0.0);
  for (int step = 0; step < 20; ++step) {
    surface.advect(velocity, 1.0, 1.0, {});
    EXPECT_LE(1.0 - surface.volume(open), 1.05 * air) << step;
    EXPECT_LE(surface.distance()[bubble], 0.6) << step;
  }
}

}  // namespace
}  // namespace monolith
