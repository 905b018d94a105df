// The compressed kernels against plain loops, those of staggered_operator.h and some of this file, on random
// coefficients with holes.

#include "solve/stokes_stencil.h"

#include <gtest/gtest.h>

#include <random>

namespace monolith {
namespace {

struct Parameters {
  std::array<int, 3> cells;
  std::array<bool, 3> periodic;
  bool viscous;
};

// (C^T p)_a / mass_a added to U_a on faces with mass.
void addPressureImpulse(const StaggeredCoefficients<double>& c, const FaceField<double>& mass,
                        const std::vector<double>& p, FaceField<double>& U) {
  forEachRow(c.lattice, [&](std::ptrdiff_t row, int, int) {
    for (int a = 0; a < 3; ++a) {
      for (auto f = row; f < row + c.lattice.faceEnd(0); ++f) {
        if (mass[a][f] > 0.0) U[a][f] += c.open(a)[f] * (p[f - c.lattice.stride[a]] - p[f]) / mass[a][f];
      }
    }
  });
}

// Diagonal of the viscous block, raised where needed so that the spectrum of D^-1 A lies in [0, kLargestScaled]
// (Gershgorin), and what ties a face to whatever has no unknown, its mass included: the block applied to a constant.
void diagonalAndTies(const StaggeredCoefficients<double>& c, FaceField<double>& diagonal, FaceField<double>& ties) {
  const Lattice& l = c.lattice;
  for (int a = 0; a < 3; ++a) {
    diagonal[a].assign(l.size, 0.0);
    ties[a].assign(l.size, 0.0);
    const auto sa = l.stride[a];
    const auto& has = c.mass[a];
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto f = row; f < row + l.faceEnd(0); ++f) {
        if (!(has[f] > 0.0)) continue;
        double own = has[f], tied = has[f], others = 0.0;
        const auto spring = [&](double stiffness, std::ptrdiff_t neighbour) {
          own += stiffness;
          (has[neighbour] > 0.0 ? others : tied) += stiffness;
        };
        if (c.viscous) {
          own += c.drag[a][f];
          tied += c.drag[a][f];
          spring(c.normal[a][f], f + sa);
          spring(c.normal[a][f - sa], f - sa);
          for (int p = 0; p < 3; ++p) {
            for (int place = 0; place < 2; ++place) {
              if (kShearPairs[p][place] != a) continue;
              const int b = kShearPairs[p][1 - place];
              const auto sb = l.stride[b];
              const auto &k = c.shear[p][place], &k_other = c.shear[p][1 - place];
              spring(k[f] * k[f], f - sb);
              spring(k[f + sb] * k[f + sb], f + sb);
              for (const auto edge : {f, f + sb}) {
                for (const auto other : {edge, edge - sa}) {
                  if (c.mass[b][other] > 0.0) others += k[edge] * k_other[edge];
                }
              }
            }
          }
          own = std::max(own, (own + others) / kLargestScaled);
        }
        diagonal[a][f] = own;
        ties[a][f] = tied;
      }
    });
  }
}

class StokesStencil : public testing::TestWithParam<Parameters> {
 protected:
  // Half of the tank is uniform, the rest has random coefficients and faces without an unknown.
  StokesStencil() {
    const Parameters p = GetParam();
    l = Lattice(p.cells, p.periodic);
    c.resize(l, p.viscous);
    FaceField<float> drag, normal;
    std::array<FaceField<float>, 2> shear;  // by place
    for (auto* fields : {&drag, &normal, &shear[0], &shear[1]}) {
      for (auto& field : *fields) field.assign(l.size, 0.0F);
    }
    for (int k = 0; k < l.faceEnd(2); ++k) {
      for (int j = 0; j < l.faceEnd(1); ++j) {
        for (int i = 0; i < l.faceEnd(0); ++i) {
          const auto f = l.index(i, j, k);
          const bool plain = k < l.n[2] / 2;
          const int at[3] = {i, j, k};
          for (int a = 0; a < 3; ++a) {
            const bool wall = at[a] == 0 && !l.periodic[a];
            const bool outside = at[0] >= l.n[0] || at[1] >= l.n[1] || at[2] >= l.n[2];
            const bool has = !wall && !outside && (plain || unit(random) > 0.2);
            c.mass[a][f] = !has ? 0.0 : plain ? 1.0 : 0.1 + unit(random);
            c.own_fluid[a][f] = !has ? 0.0 : plain ? 1.0 : 0.1 + unit(random);
            if (!p.viscous) continue;
            drag[a][f] = plain ? 0.0 : unit(random);
            normal[a][f] = plain ? 2.0 : 3.0 * unit(random);
            for (int s = 0; s < 2; ++s) shear[s][a][f] = plain ? 1.0 : 1.5 * unit(random);
          }
          c.has_pressure[f] = i < l.n[0] && j < l.n[1] && k < l.n[2] && (plain || unit(random) > 0.2);
        }
      }
    }
    for (int a = 0; a < 3; ++a) {
      for (auto* field : {&c.mass[a], &c.own_fluid[a]}) fillHalo(l, *field);
      if (!p.viscous) continue;
      c.drag[a].pack(l, drag[a]);
      c.normal[a].pack(l, normal[a]);
      for (int s = 0; s < 2; ++s) c.shear[a][s].pack(l, shear[s][a]);
    }
    for (int a = 0; a < 3; ++a) {
      U[a].assign(l.size, 0.0);
      for (std::size_t f = 0; f < l.size; ++f) U[a][f] = c.mass[a][f] > 0.0 ? unit(random) - 0.5 : 0.0;
      fillHalo(l, U[a]);
    }
    p_.assign(l.size, 0.0);
    for (std::size_t f = 0; f < l.size; ++f) p_[f] = c.has_pressure[f] ? unit(random) - 0.5 : 0.0;
    fillHalo(l, p_);
    buildFaceBlocks(c, faces, &transfer, &impulse);
    buildCellBlocks(c, cells);
  }

  template <class Field>
  static Faces<const double> view(const Field& f) {
    return {f[0].data(), f[1].data(), f[2].data()};
  }
  static Faces<double> view(FaceField<double>& f) { return {f[0].data(), f[1].data(), f[2].data()}; }
  FaceField<double> zero() const {
    return {std::vector<double>(l.size), std::vector<double>(l.size), std::vector<double>(l.size)};
  }

  // A U by the plain loops.
  FaceField<double> plainMomentum() const {
    FaceField<double> out = zero();
    StressSamples<double> stress;
    if (c.viscous) computeStress(c, U, stress);
    monolith::applyMomentum(c, U, stress, out);
    return out;
  }
  template <class F>
  void forEachCell(F&& f) const {
    for (int k = 0; k < l.faceEnd(2); ++k) {
      for (int j = 0; j < l.faceEnd(1); ++j) {
        for (int i = 0; i < l.faceEnd(0); ++i) f(l.index(i, j, k));
      }
    }
  }

  std::mt19937 random{11};
  std::uniform_real_distribution<double> unit{0.0, 1.0};
  Lattice l;
  StaggeredCoefficients<double> c;
  FaceField<double> U;
  std::vector<double> p_;
  FaceBlocks<double> faces;
  CellBlocks<double> cells;
  FaceRows<float> transfer, impulse;
};

TEST_P(StokesStencil, MomentumAndPressureForceAreThePlainOnes) {
  FaceField<double> plain = plainMomentum(), fast = zero();
  addPressureForce(c, p_, -1.0, plain);
  applyMomentum(l, faces, c.viscous, view(std::as_const(U)), static_cast<const double*>(p_.data()), view(fast));
  int unknowns = 0;
  forEachCell([&](std::ptrdiff_t f) {
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(fast[a][f], plain[a][f], 1e-12);
      unknowns += c.mass[a][f] > 0.0;
    }
  });
  EXPECT_GT(unknowns, 500);
  // Uniform parts share their patterns.
  EXPECT_LT(faces.patterns(), 0.8 * static_cast<double>(faces.blocks()));
}

TEST_P(StokesStencil, DivergenceIsThePlainOne) {
  std::vector<double> plain(l.size), fast(l.size);
  computeDivergence(c, U, plain);
  applyDivergence(l, cells, view(std::as_const(U)), 2.0, static_cast<const double*>(p_.data()), fast.data());
  forEachCell([&](std::ptrdiff_t f) {
    if (c.has_pressure[f]) {
      EXPECT_NEAR(fast[f], 2.0 * p_[f] - plain[f], 1e-13);
    }
  });
}

TEST_P(StokesStencil, ResidualsAreWhatIsLeftOfTheRightSide) {
  FaceField<double> plain = plainMomentum();
  addPressureForce(c, p_, -1.0, plain);
  std::vector<double> flux(l.size), sources(l.size);
  computeDivergence(c, U, flux);
  // Nearly all of it is taken away: what is left has the digits of double precision.
  constexpr double kLeft = 1e-6;
  FaceField<double> b = plain;
  for (auto& field : b) {
    for (double& value : field) value *= 1.0 + kLeft;
  }
  for (std::size_t i = 0; i < l.size; ++i) sources[i] = -(1.0 + kLeft) * flux[i];
  FaceField<float> r;
  for (auto& field : r) field.assign(l.size, 0.0f);
  std::vector<float> left(l.size, 0.0f);
  momentumResidual(l, faces, c.viscous, view(std::as_const(b)), view(std::as_const(U)), p_.data(),
                   {r[0].data(), r[1].data(), r[2].data()});
  divergenceResidual(l, cells, sources.data(), view(std::as_const(U)), 3.0, left.data());
  forEachCell([&](std::ptrdiff_t f) {
    for (int a = 0; a < 3; ++a) {
      if (c.mass[a][f] > 0.0) {
        EXPECT_NEAR(r[a][f], kLeft * plain[a][f], 1e-11);
      } else {
        EXPECT_EQ(r[a][f], 0.0f);
      }
    }
    EXPECT_NEAR(left[f], c.has_pressure[f] ? -3.0 * kLeft * flux[f] : 0.0, 1e-11);
  });
}

TEST_P(StokesStencil, SmootherDividesByTheSmoothingDiagonal) {
  FaceField<double> diagonal, effective;
  diagonalAndTies(c, diagonal, effective);
  const FaceField<double> AU = plainMomentum();
  FaceBlocks<float> single;
  faces.convertTo(single);
  FaceField<float> x, b, d, next;
  for (int a = 0; a < 3; ++a) {
    x[a].assign(U[a].begin(), U[a].end());
    for (auto* field : {&b[a], &d[a], &next[a]}) field->assign(l.size, 0.0f);
    for (float& v : b[a]) v = static_cast<float>(unit(random));
    for (float& v : d[a]) v = 1.0f;
  }
  const auto constant = [](const FaceField<float>& f) {
    return Faces<const float>{f[0].data(), f[1].data(), f[2].data()};
  };
  const auto mutableView = [](FaceField<float>& f) { return Faces<float>{f[0].data(), f[1].data(), f[2].data()}; };
  chebyshevStep(l, single, constant(x), constant(b), 0.5f, 0.25f, mutableView(d), mutableView(next));
  forEachCell([&](std::ptrdiff_t f) {
    for (int a = 0; a < 3; ++a) {
      if (!(c.mass[a][f] > 0.0)) continue;
      const double step = 0.5 + 0.25 * (b[a][f] - AU[a][f]) / diagonal[a][f];
      EXPECT_NEAR(d[a][f], step, 2e-6 * (1.0 + std::abs(AU[a][f])));
      EXPECT_NEAR(next[a][f], U[a][f] + step, 2e-6 * (1.0 + std::abs(AU[a][f])));
      const double tie = (effective[a][f] - c.mass[a][f]) / diagonal[a][f];
      EXPECT_NEAR(transfer[a][f], std::max(0.0, 1.0 - tie), 1e-6);
      EXPECT_NEAR(impulse[a][f], c.open(a)[f] / effective[a][f], 1e-6 * (1.0 + impulse[a][f]));
    }
  });
}

TEST_P(StokesStencil, ProjectionIsThePlainOne) {
  FaceField<double> diagonal, effective, plain = U;
  diagonalAndTies(c, diagonal, effective);
  addPressureImpulse(c, effective, p_, plain);
  FaceField<float> x, y;
  for (int a = 0; a < 3; ++a) {
    x[a].assign(U[a].begin(), U[a].end());
    y[a].assign(l.size, 0.0f);
  }
  const std::vector<float> p(p_.begin(), p_.end());
  project(l, allPlanes(l), impulse, {x[0].data(), x[1].data(), x[2].data()}, p.data(),
          {y[0].data(), y[1].data(), y[2].data()});
  forEachCell([&](std::ptrdiff_t f) {
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(y[a][f], plain[a][f], 1e-5 * (1.0 + std::abs(plain[a][f])));
  });
}

INSTANTIATE_TEST_SUITE_P(Lattices, StokesStencil,
                         testing::Values(Parameters{{8, 9, 16}, {false, false, false}, true},
                                         Parameters{{13, 6, 12}, {false, true, false}, true},
                                         Parameters{{10, 8, 12}, {true, false, true}, true},
                                         Parameters{{16, 6, 10}, {true, true, true}, true},
                                         Parameters{{9, 8, 14}, {false, false, false}, false}));

}  // namespace
}  // namespace monolith
