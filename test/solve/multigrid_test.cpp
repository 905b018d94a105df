// Convergence of the multigrid cycles by themselves, as iterations, and that they are linear maps.

#include <gtest/gtest.h>

#include <algorithm>
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
    ViscousPlane plane;
    if (number > 0.0) plane.unpack(c, k);
    for (int j = 0; j < l.faceEnd(1); ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto f = l.index(i, j, k);
        const int at[3] = {i, j, k};
        c.has_pressure[f] = i < l.n[0] && j < l.n[1] && k < std::min(fill, l.n[2]);
        for (int a = 0; a < 3; ++a) {
          bool inside = true;
          for (int b = 0; b < 3; ++b) inside = inside && at[b] < l.n[b] && (b != a || at[b] > 0);
          const bool wet = a == 2 ? k <= fill : k < fill;
          if (inside && wet) c.mass[a][f] = c.own_fluid[a][f] = 1.0;
          if (number > 0.0 && c.has_pressure[f]) plane.normal[a][f - plane.begin] = 2.0 * number;
        }
        if (number <= 0.0) continue;
        for (int p = 0; p < 3; ++p) {
          const auto [a, b] = kShearPairs[p];
          const int other = 3 - a - b;
          if (at[other] >= l.n[other] || (other == 2 ? k >= fill : k > fill)) continue;
          // On a wall the difference is over half a cell, and the energy that of half a sample.
          const bool wall_a = at[b] == 0 || at[b] == l.n[b], wall_b = at[a] == 0 || at[a] == l.n[a];
          const double weight = std::sqrt(number * (wall_a || wall_b ? 0.5 : 1.0));
          plane.shear[p][0][f - plane.begin] = weight * (wall_a ? 2.0 : 1.0);
          plane.shear[p][1][f - plane.begin] = weight * (wall_b ? 2.0 : 1.0);
        }
      }
    }
    if (number > 0.0) plane.pack(k, c);
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
      convertCoefficients(box(level, number, fill), coarse.emplace_back());
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
  std::vector<float> approximate(const std::vector<float>& right) {
    std::vector<float> out(3 * l.size, 0.0f);
    multigrid.cycle(view(right), {out.data(), out.data() + l.size, out.data() + 2 * l.size});
    return out;
  }
  // Mean factor per cycle of the residual over the later cycles.
  double factor() {
    double before = 0.0;
    for (int cycle = 0; cycle < 6; ++cycle) {
      applyMomentum(l, blocks, true, view(x), static_cast<const float*>(zero.data()),
                    {r.data(), r.data() + l.size, r.data() + 2 * l.size});
      for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
      if (cycle == 2) before = norm(r);
      const std::vector<float> d = approximate(r);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += d[i];
    }
    return std::pow(norm(r) / before, 1.0 / 3.0);
  }
  Lattice l;
  FaceBlocks<float> blocks;
  FaceRows<float> transfer;
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

// |f(a + 2 b) - f(a) - 2 f(b)| relative to |f(a)| + 2 |f(b)|, of a function from fields to fields.
template <class Function>
double nonlinearity(const std::vector<float>& a, const std::vector<float>& b, Function&& f) {
  std::vector<float> sum(a);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += 2.0f * b[i];
  const std::vector<float> of_a = f(a), of_b = f(b);
  std::vector<float> difference = f(sum);
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= of_a[i] + 2.0f * of_b[i];
  return norm(difference) / (norm(of_a) + 2.0 * norm(of_b));
}

TEST(VelocityMultigrid, IsLinear) {
  VelocityCase c(12, 3.0, 7);
  const auto cycle = [&](const std::vector<float>& b) { return c.approximate(b); };
  std::vector<float> other(c.b), twice(c.b);
  std::reverse(other.begin(), other.end());  // other numbers where there are unknowns
  for (std::size_t i = 0; i < other.size(); ++i) {
    if (c.b[i] == 0.0f) other[i] = 0.0f;
  }
  ASSERT_GT(norm(other), 0.1 * norm(c.b));
  EXPECT_LT(nonlinearity(c.b, other, cycle), 1e-5);
  for (float& v : twice) v *= 2.0f;
  const std::vector<float> once = cycle(c.b), doubled = cycle(twice);
  ASSERT_GT(norm(once), 0.0);
  for (std::size_t i = 0; i < once.size(); ++i) ASSERT_EQ(doubled[i], 2.0f * once[i]);
}

// The network of a box of liquid with a hole, filled up to `fill`.
struct PressureCase {
  PressureCase(int n, int fill) : l({n, n, n}, {false, false, false}), c(box(l, 0.0, fill)) {
    for (int k = n / 4; k < n / 2; ++k) {
      for (int j = n / 4; j < n / 2; ++j) {
        for (int i = n / 3; i < n / 2; ++i) {
          const auto f = l.index(i, j, k);
          c.has_pressure[f] = 0;
          for (int a = 0; a < 3; ++a) {
            for (const auto face : {f, f + l.stride[a]}) c.mass[a][face] = c.own_fluid[a][face] = 0.0;
          }
        }
      }
    }
    FaceBlocks<float> faces;
    buildFaceBlocks(c, faces, nullptr, &impulse);
    buildCellBlocks(c, cells);
  }
  std::vector<float> zero() const { return std::vector<float>(l.size, 0.0f); }
  // b without its mean, which a full box doesn't take.
  void removeMean(std::vector<float>& b) const {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < l.size; ++i) {
      if (c.has_pressure[i]) sum += b[i], ++count;
    }
    for (std::size_t i = 0; i < l.size; ++i) {
      if (c.has_pressure[i]) b[i] -= static_cast<float>(sum / count);
    }
  }
  // b - L x
  std::vector<float> residual(const std::vector<float>& b, const std::vector<float>& x) const {
    std::vector<float> flow(3 * l.size, 0.0f), r = zero();
    const std::vector<float> still(flow);
    const std::size_t n = l.size;
    project(l, allPlanes(l), impulse, {still.data(), still.data() + n, still.data() + 2 * n}, x.data(),
            {flow.data(), flow.data() + n, flow.data() + 2 * n});
    applyDivergence(l, cells, {flow.data(), flow.data() + n, flow.data() + 2 * n}, 1.0f,
                    static_cast<const float*>(b.data()), r.data());
    return r;
  }

  Lattice l;
  StaggeredCoefficients<double> c;
  CellBlocks<float> cells;
  FaceRows<float> impulse;
};

// Factor of the residual over a cycle.
double pressureFactor(int n, int fill) {
  const PressureCase p(n, fill);
  PressureMultigrid multigrid;
  multigrid.set(p.l, p.c.has_pressure, p.c.fluid(), p.impulse);
  std::vector<float> x = p.zero(), b = x, r;
  std::mt19937 random(3);
  std::normal_distribution<float> gauss;
  for (std::size_t i = 0; i < p.l.size; ++i) {
    if (p.c.has_pressure[i]) b[i] = gauss(random);
  }
  p.removeMean(b);
  double before = 0.0;
  for (int cycle = 0; cycle < 5; ++cycle) {
    r = p.residual(b, x);
    if (cycle == 2) before = norm(r);
    const float* d = multigrid.cycle(r.data());
    for (std::size_t i = 0; i < p.l.size; ++i) x[i] += p.c.has_pressure[i] ? d[i] : 0.0f;
  }
  return std::sqrt(norm(r) / before);
}

TEST(PressureMultigrid, ConvergesAtAnySizeWithAndWithoutASurface) {
  for (const int n : {13, 16, 32, 40}) {
    EXPECT_LT(pressureFactor(n, 1000), 0.3) << n << " cells, full";
    EXPECT_LT(pressureFactor(n, 5 * n / 8), 0.3) << n << " cells, with a surface";
  }
}

TEST(PressureMultigrid, IsLinear) {
  for (const int fill : {1000, 9}) {
    const PressureCase p(16, fill);
    PressureMultigrid multigrid;
    multigrid.set(p.l, p.c.has_pressure, p.c.fluid(), p.impulse);
    const auto cycle = [&](const std::vector<float>& b) {
      const float* x = multigrid.cycle(b.data());
      std::vector<float> out = p.zero();
      for (std::size_t i = 0; i < p.l.size; ++i) out[i] = p.c.has_pressure[i] ? x[i] : 0.0f;
      if (fill > p.l.n[2]) p.removeMean(out);  // of which a full box amplifies the round-off
      return out;
    };
    std::vector<float> a = p.zero(), b = a;
    std::mt19937 random(5);
    std::normal_distribution<float> gauss;
    for (std::size_t i = 0; i < p.l.size; ++i) {
      if (p.c.has_pressure[i]) a[i] = gauss(random), b[i] = gauss(random);
    }
    p.removeMean(a);
    p.removeMean(b);
    EXPECT_GT(norm(cycle(a)), 0.0);
    EXPECT_LT(nonlinearity(a, b, cycle), 1e-3) << fill;
  }
}

// Away from the cells that are smoothed, long waves come out as they should all the same.
TEST(PressureMultigrid, LeavesLongWavesToTheCoarserLevels) {
  for (const int fill : {1000, 20}) {
    const PressureCase p(32, fill);
    const Lattice& l = p.l;
    std::vector<std::uint8_t> smoothed(l.size, 0);
    std::vector<float> b = p.zero(), exact = b;
    int count = 0, inside = 0;
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) {
          const auto f = l.index(i, j, k);
          for (const auto s : l.stride) smoothed[f] |= !p.c.has_pressure[f - s] || !p.c.has_pressure[f + s];
          if (!p.c.has_pressure[f]) continue;
          b[f] = static_cast<float>(std::cos(M_PI * (i + 0.5) / 16.0) * std::cos(M_PI * (k + 0.5) / 32.0));
          count += smoothed[f];
          ++inside;
        }
      }
    }
    ASSERT_LT(count, inside / 2);
    p.removeMean(b);
    PressureMultigrid everywhere, partly;
    everywhere.set(l, p.c.has_pressure, p.c.fluid(), p.impulse);
    partly.set(l, p.c.has_pressure, p.c.fluid(), p.impulse, nullptr, &smoothed);
    for (int cycle = 0; cycle < 12; ++cycle) {
      const std::vector<float> r = p.residual(b, exact);
      const float* d = everywhere.cycle(r.data());
      for (std::size_t i = 0; i < l.size; ++i) exact[i] += p.c.has_pressure[i] ? d[i] : 0.0f;
    }
    ASSERT_LT(norm(p.residual(b, exact)), 1e-3 * norm(b));
    const bool full = fill > l.n[2];  // else the mean is part of the answer
    if (full) p.removeMean(exact);
    // Twice, since what a cycle leaves behind must not matter.
    for (int again = 0; again < 2; ++again) {
      const float* x = partly.cycle(b.data());
      std::vector<float> difference = p.zero(), found = difference;
      for (std::size_t i = 0; i < l.size; ++i) found[i] = p.c.has_pressure[i] ? x[i] : 0.0f;
      if (full) p.removeMean(found);
      for (std::size_t i = 0; i < l.size; ++i) difference[i] = found[i] - exact[i];
      EXPECT_LT(norm(difference), 0.15 * norm(exact)) << fill;
    }
  }
}

// The liquid rises and falls: what it has left behind must not matter, wherever it is smoothed.
TEST(PressureMultigrid, IsWhatANewOneWouldBeAfterTheSurfaceHasMoved) {
  for (const bool part : {false, true}) {
    PressureMultigrid kept;
    for (const int fill : {20, 17, 16, 11, 23, 12, 13}) {
      const PressureCase p(24, fill);
      const Lattice& l = p.l;
      std::vector<std::uint8_t> smoothed(l.size, 0);
      std::vector<float> b = p.zero();
      std::mt19937 random(fill);
      std::normal_distribution<float> gauss;
      for (int k = 0; k < l.n[2]; ++k) {
        for (int j = 0; j < l.n[1]; ++j) {
          for (int i = 0; i < l.n[0]; ++i) {
            const auto f = l.index(i, j, k);
            for (const auto s : l.stride) smoothed[f] |= !p.c.has_pressure[f - s] || !p.c.has_pressure[f + s];
            if (p.c.has_pressure[f]) b[f] = gauss(random);
          }
        }
      }
      PressureMultigrid fresh;
      for (PressureMultigrid* m : {&kept, &fresh}) {
        m->set(l, p.c.has_pressure, p.c.fluid(), p.impulse, nullptr, part ? &smoothed : nullptr);
      }
      const std::vector<float> again(kept.cycle(b.data()), kept.cycle(b.data()) + l.size);
      const float* once = fresh.cycle(b.data());
      for (std::size_t c = 0; c < l.size; ++c) ASSERT_EQ(again[c], once[c]) << fill << (part ? ", in part" : "");
    }
  }
}

}  // namespace
}  // namespace monolith
