#include "fluid/advection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fluid/interpolation.h"

namespace monolith {
namespace {

constexpr double kEverywhere = 1e9;

TEST(Interpolation, CubicReproducesCubicsAndNodes) {
  const Lattice l({8, 8, 8}, {false, false, false});
  std::vector<double> field(l.size);
  const auto f = [](double x, double y, double z) { return 1.0 + x - y * y + 0.1 * x * x * x + 0.2 * x * y * z; };
  for (int k = -1; k < 10; ++k) {
    for (int j = -1; j < 10; ++j) {
      for (int i = -1; i < 10; ++i) field[l.index(i, j, k)] = f(i, j, k);
    }
  }
  EXPECT_NEAR(sampleCubic(l, field, {3.3, 2.7, 4.1}, false), f(3.3, 2.7, 4.1), 1e-10);
  EXPECT_EQ(sampleCubic(l, field, {3.0, 2.0, 4.0}, false), field[l.index(3, 2, 4)]);
  EXPECT_EQ(sampleLinear(l, field, {3.0, 2.0, 4.0}), field[l.index(3, 2, 4)]);
}

// Error after a periodic shear wave has been carried once around.
double errorAfterARound(int n) {
  MacGrid grid;
  grid.lattice = Lattice({n, 4, 4}, {true, true, true});
  grid.h = 1.0 / n;
  const Lattice& l = grid.lattice;
  FaceField<double> u, moved;
  std::array<std::vector<std::uint8_t>, 3> known;
  for (int a = 0; a < 3; ++a) {
    u[a].assign(l.size, a == 0 ? 1.0 : 0.0);
    known[a].assign(l.size, 1);
  }
  const auto wave = [&](int i) { return 0.1 * std::sin(2.0 * M_PI * (i + 0.5) / n); };
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < n; ++i) u[1][l.index(i, j, k)] = wave(i);
    }
  }
  fillHalo(l, u[1]);
  const int steps = n * 2;
  for (int s = 0; s < steps; ++s) {
    advectVelocity(grid, u, known, 1.0 / steps, moved);
    u = moved;
    for (auto& field : u) fillHalo(l, field);
  }
  double error = 0.0;
  for (int i = 0; i < n; ++i) error = std::max(error, std::abs(u[1][l.index(i, 1, 1)] - wave(i)));
  return error;
}

TEST(Advection, IsOfSecondOrderOrBetter) {
  const double coarse = errorAfterARound(16);
  const double fine = errorAfterARound(32);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(std::log2(coarse / fine), 1.9);
}

// Rows are moved four faces at a time; that must be what happens to each by itself.
TEST(Advection, RowsMoveAsTheirFacesDo) {
  for (const bool periodic : {false, true}) {
    MacGrid grid;
    grid.lattice = Lattice({11, 9, 10}, {periodic, false, periodic});
    const Lattice& l = grid.lattice;
    FaceField<double> u, moved;
    std::array<std::vector<std::uint8_t>, 3> known;
    for (int a = 0; a < 3; ++a) {
      u[a].assign(l.size, 0.0);
      known[a].assign(l.size, 1);
      for (int k = -1; k < 12; ++k) {
        for (int j = -1; j < 11; ++j) {
          for (int i = -1; i < 13; ++i) {
            // Speeds up to 1.3 cells a step, of both signs, and rough enough for the limiter.
            u[a][l.index(i, j, k)] =
                std::sin(0.4 * i + 0.3 * a) * std::cos(0.5 * j + 0.2 * k) + 0.3 * ((i + j) % 3 == 0);
          }
        }
      }
      fillHalo(l, u[a]);
    }
    advectVelocity(grid, u, known, 1.0, moved);
    double largest = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < l.faceEnd(2); ++k) {
        for (int j = 0; j < l.faceEnd(1); ++j) {
          for (int i = 0; i < l.faceEnd(0); ++i) {
            const int at[3] = {i, j, k};
            bool beyond = false;  // the tank
            for (int d = 0; d < 3; ++d) beyond = beyond || (d != a && at[d] == l.n[d]);
            const bool in_wall = !l.periodic[a] && (at[a] == 0 || at[a] == l.n[a]);
            if (beyond) continue;
            const double expected = in_wall ? u[a][l.index(i, j, k)] : advectFace(l, u, a, {i, j, k}, 1.0);
            EXPECT_NEAR(moved[a][l.index(i, j, k)], expected, 1e-13) << a << " " << i << " " << j << " " << k;
            largest = std::max(largest, std::abs(expected));
          }
        }
      }
    }
    EXPECT_GT(largest, 0.5);
    // The same with accelerations, at steps whose feet lie within half a cell and beyond.
    const FaceField<double> acceleration = {u[1], u[2], u[0]};
    FaceField<double> mean = u, gained, work;
    const double dt = 0.7;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < l.size; ++f) mean[a][f] += 0.5 * dt * acceleration[a][f];
    }
    advectAccelerated(grid, u, acceleration, known, dt, moved, gained, work);
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < l.faceEnd(2); ++k) {
        for (int j = 0; j < l.faceEnd(1); ++j) {
          for (int i = 0; i < l.faceEnd(0); ++i) {
            const int at[3] = {i, j, k};
            bool beyond = false;  // the tank, where the sampling clamps
            for (int d = 0; d < 3; ++d) beyond = beyond || (d != a && at[d] == l.n[d]);
            if (beyond || (!l.periodic[a] && (at[a] == 0 || at[a] == l.n[a]))) continue;
            const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + nodeOffset(a);
            const Eigen::Vector3d foot = x - dt * velocityAt(l, mean, x - dt * velocityAt(l, mean, x)) - nodeOffset(a);
            EXPECT_NEAR(moved[a][l.index(i, j, k)], sampleCubic(l, u[a], foot, true), 1e-13) << a << i << j << k;
            EXPECT_NEAR(gained[a][l.index(i, j, k)], sampleLinear(l, acceleration[a], foot), 1e-13) << a << i << j << k;
          }
        }
      }
    }
    std::vector<double> cells;
    advectCells(grid, u, u[1], 1.0, kEverywhere, cells);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) {
          EXPECT_NEAR(cells[l.index(i, j, k)], advectCell(l, u, u[1], {i, j, k}, 1.0), 1e-13);
        }
      }
    }
  }
}

TEST(Advection, AtRestNothingChangesABit) {
  MacGrid grid;
  grid.lattice = Lattice({6, 6, 6}, {false, false, false});
  const Lattice& l = grid.lattice;
  FaceField<double> zero;
  for (auto& field : zero) field.assign(l.size, 0.0);
  std::vector<double> field(l.size), moved;
  for (std::size_t c = 0; c < l.size; ++c) field[c] = std::sin(0.1 * static_cast<double>(c));
  advectCells(grid, zero, field, 0.1, kEverywhere, moved);
  EXPECT_EQ(field, moved);
}

}  // namespace
}  // namespace monolith
