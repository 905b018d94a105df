#include "coupling/pressure_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace monolith {
namespace {

struct Region {
  std::set<std::ptrdiff_t> cells;
  bool sealed = true;
};

// Flood fill, cell by cell.
std::vector<Region> floodFill(const StaggeredCoefficients<double>& c) {
  const Lattice& l = c.lattice;
  std::vector<Region> regions;
  std::vector<char> seen(l.size, 0);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto start = l.index(i, j, k);
        if (!c.has_pressure[start] || seen[start]) continue;
        Region region;
        std::vector<std::ptrdiff_t> open_ends{start};
        seen[start] = 1;
        while (!open_ends.empty()) {
          const auto cell = open_ends.back();
          open_ends.pop_back();
          region.cells.insert(cell);
          for (int a = 0; a < 3; ++a) {
            for (const int side : {-1, 1}) {
              auto at = l.cell(cell);
              at[a] += side;
              if (l.periodic[a]) at[a] = (at[a] + l.n[a]) % l.n[a];
              const bool inside = at[a] >= 0 && at[a] < l.n[a];
              const auto other = inside ? l.index(at[0], at[1], at[2]) : cell + side * l.stride[a];
              auto face = side < 0 ? cell : other;
              if (side > 0 && !inside) face = cell + l.stride[a];
              if (!(c.open(a)[face] > 0.0)) continue;
              if (!inside || !c.has_pressure[other]) {
                region.sealed = false;
              } else if (!seen[other]) {
                seen[other] = 1;
                open_ends.push_back(other);
              }
            }
          }
        }
        regions.push_back(region);
      }
    }
  }
  return regions;
}

// Walls all around, some cells without pressure, some faces closed: many regions, some of them sealed.
StaggeredCoefficients<double> randomRegions(unsigned seed, const std::array<bool, 3>& periodic, double closed) {
  const Lattice l({9, 7, 6}, periodic);
  StaggeredCoefficients<double> c;
  c.resize(l, false);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      const bool whole = unit(random) < 0.3;  // from wall to wall
      for (int i = 0; i < l.n[0]; ++i) {
        const auto cell = l.index(i, j, k);
        c.has_pressure[cell] = whole || unit(random) < 0.9;
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          const bool wall = at[a] == 0 && !periodic[a];
          c.mass[a][cell] = wall || (unit(random) < closed && !(whole && a == 0)) ? 0.0 : 0.5;
        }
      }
    }
  }
  for (auto& field : c.mass) fillHalo(l, field);
  c.own_fluid = c.mass;
  return c;
}

TEST(PressureRegions, AreThoseOfAFloodFill) {
  std::size_t sealed = 0, open = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const std::array<bool, 3> periodic{seed % 2 == 1, seed % 3 == 1, seed % 5 == 1};
    // From one region with all cells to many small ones.
    const auto c = randomRegions(seed, periodic, 0.1 * (seed % 10));
    const std::vector<Region> expected = floodFill(c);
    const std::vector<PressureRegion> found = findPressureRegions(c, BodyRows(), BodyCoordinates());
    ASSERT_EQ(found.size(), expected.size()) << seed;
    for (std::size_t r = 0; r < found.size(); ++r) {
      EXPECT_EQ(found[r].sealed, expected[r].sealed) << seed;
      EXPECT_EQ(found[r].null_mode, expected[r].sealed) << seed;
      if (!found[r].sealed) {
        ++open;
        continue;
      }
      ++sealed;
      std::set<std::ptrdiff_t> cells;
      for (const auto& run : found[r].runs) {
        for (auto cell = run.begin; cell < run.end; ++cell) cells.insert(cell);
      }
      EXPECT_EQ(cells, expected[r].cells) << seed;
      EXPECT_EQ(found[r].cells, expected[r].cells.size()) << seed;
    }
  }
  EXPECT_GT(sealed, 100u);
  EXPECT_GT(open, 100u);
}

BodyCoordinates oneBody(BodyMotion motion) {
  RigidBody body;
  body.motion = motion;
  BodyCoordinates out;
  out.set({body});
  return out;
}

// What a body pushes into a sealed region decides whether its pressure is free.
TEST(PressureRegions, AFreeBodyFeelsTheConstantUnlessItsRowsCancel) {
  auto c = randomRegions(1, {false, false, false}, 0.0);
  std::fill(c.has_pressure.begin(), c.has_pressure.end(), 0);
  const Lattice& l = c.lattice;
  for (int i = 0; i < l.n[0]; ++i) c.has_pressure[l.index(i, 2, 3)] = 1;
  for (int i = 0; i < l.n[0]; ++i) {
    for (int a = 1; a < 3; ++a) c.mass[a][l.index(i, 2, 3)] = c.mass[a][l.index(i, 2, 3) + l.stride[a]] = 0.0;
    c.mass[0][l.index(i, 2, 3)] = i > 0 ? 1.0 : 0.0;
  }
  c.own_fluid = c.mass;
  BodyRows rows;
  rows.divergence.push_back({l.index(1, 2, 3), 0, Vector6d::Unit(0)});
  EXPECT_FALSE(findPressureRegions(c, rows, oneBody(BodyMotion::kFree)).at(0).null_mode);
  EXPECT_TRUE(findPressureRegions(c, rows, oneBody(BodyMotion::kFixed)).at(0).null_mode)
      << "its twist is not an unknown";
  rows.divergence.push_back({l.index(5, 2, 3), 0, -Vector6d::Unit(0)});
  EXPECT_TRUE(findPressureRegions(c, rows, oneBody(BodyMotion::kFree)).at(0).null_mode)
      << "what it pushes in it takes out elsewhere";
  EXPECT_TRUE(findPressureRegions(c, rows, oneBody(BodyMotion::kFree)).at(0).sealed);
}

}  // namespace
}  // namespace monolith
