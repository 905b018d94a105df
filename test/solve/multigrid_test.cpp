// Convergence of the multigrid cycles by themselves, as iterations, and that they are linear maps.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solve/pressure_multigrid.h"
#include "solve/staggered_transfer.h"
#include "solve/velocity_multigrid.h"

namespace monolith {
namespace {

// A box of liquid with no-slip walls; above `fill` cells there is air.
StaggeredCoefficients<double> box(const Lattice& l, double number, int fill) {
  StaggeredCoefficients<double> c;
  c.resize(l, number > 0.0);
  for (int k = 0; k < l.faceEnd(2); ++k) {
    for (int j = 0; j < l.faceEnd(1); ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto f = l.index(i, j, k);
        const int at[3] = {i, j, k};
        c.has_pressure[f] = i < l.n[0] && j < l.n[1] && k < std::min(fill, l.n[2]);
        for (int a = 0; a < 3; ++a) {
          bool inside = true;
          for (int b = 0; b < 3; ++b) inside = inside && at[b] < l.n[b] && (b != a || at[b] > 0);
          const bool wet = a == 2 ? k <= fill : k < fill;
          if (inside && wet) c.mass[a][f] = c.open[a][f] = 1.0;
          if (number > 0.0 && c.has_pressure[f]) c.normal[a][f] = 2.0 * number;
        }
        if (number <= 0.0) continue;
        for (int p = 0; p < 3; ++p) {
          const auto [a, b] = kShearPairs[p];
          const int other = 3 - a - b;
          if (at[other] >= l.n[other] || (other == 2 ? k >= fill : k > fill)) continue;
          // On a wall the difference is over half a cell, and the energy that of half a sample.
          const bool wall_a = at[b] == 0 || at[b] == l.n[b], wall_b = at[a] == 0 || at[a] == l.n[a];
          const double weight = std::sqrt(number * (wall_a || wall_b ? 0.5 : 1.0));
          c.shear[p][0][f] = weight * (wall_a ? 2.0 : 1.0);
          c.shear[p][1][f] = weight * (wall_b ? 2.0 : 1.0);
        }
      }
    }
  }
  return c;
}

double norm(const std::vector<float>& v) {
  double sum = 0.0;
  for (const float x : v) sum += static_cast<double>(x) * x;
  return std::sqrt(sum);
}

struct VelocityCase {
  explicit VelocityCase(int n, double number, int fill = 1000) : l({n, n, n}, {false, false, false}) {
    const auto fine = box(l, number, fill);
    buildFaceBlocks(fine, blocks, &transfer, nullptr);
    coarse.resize(1);
    for (Lattice level = l; canCoarsen(level) && number > 0.05;) {
      level = coarsened(level);
      number *= 0.25;
      fill = (fill + 1) / 2;
      coarse.push_back(convertCoefficients<float>(box(level, number, fill)));
    }
    multigrid.set(l, blocks, std::move(transfer), coarse, coarse.size(), 1, 2);
    x.assign(3 * l.size, 0.0f);
    b = r = x;
    zero.assign(l.size, 0.0f);
    std::mt19937 random(3);
    std::normal_distribution<float> gauss;
    blocks.forEach([&](int a, std::ptrdiff_t f, const float* k) {
      for (int i = 0; i < kLanes; ++i) b[a * l.size + f + i] = k[i] > 0.0f ? gauss(random) : 0.0f;
    });
  }
  Faces<const float> view(const std::vector<float>& v) const {
    return {v.data(), v.data() + l.size, v.data() + 2 * l.size};
  }
  // Mean factor per cycle of the residual over the later cycles.
  double factor() {
    double before = 0.0;
    for (int cycle = 0; cycle < 6; ++cycle) {
      applyMomentum(l, blocks, true, view(x), static_cast<const float*>(zero.data()),
                    {r.data(), r.data() + l.size, r.data() + 2 * l.size});
      for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
      if (cycle == 2) before = norm(r);
      const Faces<const float> d = multigrid.cycle(view(r));
      for (int a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < l.size; ++i) x[a * l.size + i] += d[a][i];
      }
    }
    return std::pow(norm(r) / before, 1.0 / 3.0);
  }
  Lattice l;
  FaceBlocks<float> blocks;
  FaceField<float> transfer;
  std::vector<StaggeredCoefficients<float>> coarse;
  VelocityMultigrid multigrid;
  std::vector<float> x, b, r, zero;
};

TEST(VelocityMultigrid, ConvergesAtAnyViscosityAndSize) {
  for (const double number : {0.01, 1.0, 100.0}) {
    for (const int n : {13, 16, 32}) {
      const double factor = VelocityCase(n, number).factor();
      EXPECT_LT(factor, 0.35) << n << " cells, viscous number " << number;
    }
  }
}

TEST(VelocityMultigrid, IsLinear) {
  VelocityCase c(12, 3.0, 7);
  std::vector<float> twice(c.b);
  for (float& v : twice) v *= 2.0f;
  std::vector<float> once(3 * c.l.size);
  const Faces<const float> x = c.multigrid.cycle(c.view(c.b));
  for (int a = 0; a < 3; ++a) std::copy_n(x[a], c.l.size, once.begin() + a * c.l.size);
  const Faces<const float> y = c.multigrid.cycle(c.view(twice));
  ASSERT_GT(norm(once), 0.0);
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < c.l.size; ++i) ASSERT_EQ(y[a][i], 2.0f * once[a * c.l.size + i]);
  }
}

// Factor of the residual over a cycle; the network of a box of liquid with a hole, filled up to `fill`.
double pressureFactor(int n, int fill) {
  const Lattice l({n, n, n}, {false, false, false});
  StaggeredCoefficients<double> c = box(l, 0.0, fill);
  for (int k = n / 4; k < n / 2; ++k) {
    for (int j = n / 4; j < n / 2; ++j) {
      for (int i = n / 3; i < n / 2; ++i) {
        const auto f = l.index(i, j, k);
        c.has_pressure[f] = 0;
        for (int a = 0; a < 3; ++a) {
          for (const auto face : {f, f + l.stride[a]}) c.mass[a][face] = c.open[a][face] = 0.0;
        }
      }
    }
  }
  FaceBlocks<float> faces;
  CellBlocks<float> cells;
  FaceField<float> conductance;
  buildFaceBlocks(c, faces, nullptr, &conductance);
  buildCellBlocks(c, cells);
  PressureMultigrid multigrid;
  multigrid.set(l, c.has_pressure, conductance);
  std::vector<float> x(l.size, 0.0f), b(x), r(x), flow(3 * l.size, 0.0f), still(flow);
  std::mt19937 random(3);
  std::normal_distribution<float> gauss;
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < l.size; ++i) {
    if (c.has_pressure[i]) sum += b[i] = gauss(random), ++count;
  }
  for (std::size_t i = 0; i < l.size; ++i) {
    if (c.has_pressure[i]) b[i] -= static_cast<float>(sum / count);  // a full box takes no constant
  }
  const auto view = [&](std::vector<float>& v) {
    return Faces<float>{v.data(), v.data() + l.size, v.data() + 2 * l.size};
  };
  double before = 0.0;
  for (int cycle = 0; cycle < 5; ++cycle) {
    project(l, faces, {still.data(), still.data() + l.size, still.data() + 2 * l.size}, x.data(), view(flow));
    applyDivergence(l, cells, {flow.data(), flow.data() + l.size, flow.data() + 2 * l.size}, 1.0f,
                    static_cast<const float*>(b.data()), r.data());
    if (cycle == 2) before = norm(r);
    const float* d = multigrid.cycle(r.data());
    for (std::size_t i = 0; i < l.size; ++i) x[i] += c.has_pressure[i] ? d[i] : 0.0f;
  }
  return std::sqrt(norm(r) / before);
}

TEST(PressureMultigrid, ConvergesAtAnySizeWithAndWithoutASurface) {
  for (const int n : {13, 16, 32, 40}) {
    EXPECT_LT(pressureFactor(n, 1000), 0.3) << n << " cells, full";
    EXPECT_LT(pressureFactor(n, 5 * n / 8), 0.3) << n << " cells, with a surface";
  }
}

}  // namespace
}  // namespace monolith
