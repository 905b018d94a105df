#include "coupling/fraction_coefficients.h"

#include <cmath>

#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

// Less of a face than this is closed: no tiny pivots. The finest level has no such faces (solid_fractions.h).
constexpr double kLeastFluid = 1e-3;
// Less liquid than this in a face is none: no tiny pivots.
constexpr double kLeastLiquid = 1e-3;

// The rows of one body, from its fractions of the faces around each sample.
class RowBuilder {
 public:
  RowBuilder(const MacGrid& grid, const BodyFractions& fractions, const RigidBody& body, int index,
             const StaggeredCoefficients<double>& coefficients)
      : grid_(grid), fractions_(fractions), body_(body), index_(index), coefficients_(coefficients) {}

  // W(c + a) row(x + h a) - W(c) row(x): along its own axis a rigid motion does not change.
  void addNormal(int a, const Cell& local, const Cell& at, std::vector<BodyRow>& out) const {
    const auto c = grid_.lattice.indexInTank(at);
    if (c < 0 || !(coefficients_.normal[a][c] > 0.0)) return;
    Cell next = local;
    ++next[a];
    const double difference = fraction(a, next) - fraction(a, local);
    if (difference == 0.0) return;
    out.push_back({c, index_, difference * velocityRow(a, grid_.faceCenter(a, at[0], at[1], at[2]), body_.p_WBcm)});
  }

  // Component a differs along b and component b along a. About the middle x of the edge each difference is that of the
  // fractions times row(x), plus their mean times the rotation's part; the two rotations are opposite.
  void addShear(int pair, const Cell& local, const Cell& at, std::vector<BodyRow>& out) const {
    const auto [a, b] = kShearPairs[pair];
    const auto e = edgeIndex(grid_.lattice, pair, at);
    if (e < 0 || !(coefficients_.shear[pair][0][e] > 0.0)) return;
    Cell below_a = local, below_b = local;
    --below_b[b];
    --below_a[a];
    const double a_low = fraction(a, below_b), a_high = fraction(a, local);
    const double b_low = fraction(b, below_a), b_high = fraction(b, local);
    const double rotation = 0.5 * grid_.h * ((a_high + a_low) - (b_high + b_low));
    if (a_high == a_low && b_high == b_low && rotation == 0.0) return;
    Eigen::Vector3d x = grid_.faceCenter(a, at[0], at[1], at[2]);
    x[b] -= 0.5 * grid_.h;
    Vector6d row =
        (a_high - a_low) * velocityRow(a, x, body_.p_WBcm) + (b_high - b_low) * velocityRow(b, x, body_.p_WBcm);
    row.tail<3>() += rotation * Eigen::Vector3d::Unit(b).cross(Eigen::Vector3d::Unit(a));
    out.push_back({e, index_, coefficients_.shear[pair][0][e] * row});
  }

 private:
  double fraction(int a, Cell local) const {
    for (int d = 0; d < 3; ++d) {
      local[d] = fractions_.within(d, local[d]);
      if (local[d] < 0) return 0.0;
    }
    return fractions_.face[a][fractions_.local(local[0], local[1], local[2])];
  }

  const MacGrid& grid_;
  const BodyFractions& fractions_;
  const RigidBody& body_;
  int index_;
  const StaggeredCoefficients<double>& coefficients_;
};

void addStressRows(const MacGrid& grid, const BodyFractions& fractions, const RigidBody& body, int index,
                   const StaggeredCoefficients<double>& coefficients, BodyRows& out) {
  const RowBuilder builder(grid, fractions, body, index, coefficients);
  for (int k = 0; k < fractions.count[2]; ++k) {
    for (int j = 0; j < fractions.count[1]; ++j) {
      for (int i = 0; i < fractions.count[0]; ++i) {
        const Cell local = {i, j, k};
        const Cell at = {fractions.low[0] + i, fractions.low[1] + j, fractions.low[2] + k};
        for (int q = 0; q < 3; ++q) {
          builder.addNormal(q, local, at, out.normal[q]);
          builder.addShear(q, local, at, out.shear[q]);
        }
      }
    }
  }
}

}  // namespace

FractionGeometry sampleFractions(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                 const SolidFractions& solids, const std::vector<double>& liquid_distance,
                                 bool viscous) {
  FractionGeometry geometry;
  geometry.fluid = solids.fluid;
  std::vector<StressFractions> parts;
  if (viscous) sampleStressFractions(grid, bodies, solids, geometry.stress, parts);
  sampleLiquidFractions(grid.lattice, liquid_distance, viscous, geometry.liquid);
  return geometry;
}

void buildFractionCoefficients(const Lattice& l, const FractionGeometry& g, double viscous_number,
                               StaggeredCoefficients<double>& out, StrainScales* strain) {
  out.resize(l, viscous_number > 0.0);
  for (auto& field : out.own_fluid) field.assign(l.size, 1.0);
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (auto f = row; f < row + width; ++f) {
      for (int a = 0; a < 3; ++a) {
        if (g.fluid[a][f] < kLeastFluid || g.liquid.face[a][f] < kLeastLiquid) continue;
        out.mass[a][f] = g.liquid.face[a][f] / g.fluid[a][f];
      }
    }
  });
  for (auto& field : out.mass) fillHalo(l, field);
  const auto isOpen = [&](int a, std::ptrdiff_t f) { return out.mass[a][f] > 0.0; };
  const auto isClosed = [&](int a, std::ptrdiff_t f) { return g.fluid[a][f] < kLeastFluid; };
  // Open, but without inertia: its velocity is whatever costs nothing.
  const auto isAir = [&](int a, std::ptrdiff_t f) { return !isOpen(a, f) && !isClosed(a, f); };
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    for (auto c = row; c < row + l.n[0]; ++c) {
      if (j >= l.n[1] || k >= l.n[2] || !(g.liquid.cell[c] > 0.0)) continue;
      bool open = false, air = false;
      for (int a = 0; a < 3; ++a) {
        for (const auto f : {c, c + l.stride[a]}) {
          open = open || isOpen(a, f);
          air = air || isAir(a, f);
        }
      }
      out.has_pressure[c] = open && !air;
    }
  });
  if (!out.viscous) return;

  if (strain != nullptr) strain->resize(l);
  const auto buildRow = [&](std::ptrdiff_t row, int j, int k, ViscousPlane& plane) {
    for (int i = 0; i < width; ++i) {
      const auto c = row + i, at = c - plane.begin;
      if (i < l.n[0] && j < l.n[1] && k < l.n[2]) {
        for (int a = 0; a < 3; ++a) {
          if (isAir(a, c) || isAir(a, c + l.stride[a])) continue;
          plane.normal[a][at] = static_cast<float>(2.0 * viscous_number * g.liquid.cell[c] * g.stress.cell[c]);
          if (strain != nullptr && plane.normal[a][at] > 0.0F) strain->normal[a][c] = 1.0;
        }
      }
      for (int p = 0; p < 3; ++p) {
        const auto [a, b] = kShearPairs[p];
        if (isAir(a, c) || isAir(a, c - l.stride[b]) || isAir(b, c) || isAir(b, c - l.stride[a])) continue;
        const double factor = std::sqrt(viscous_number * g.liquid.edge[p][c] * g.stress.edge[p][c]);
        for (auto& field : plane.shear[p]) field[at] = static_cast<float>(factor);
        if (strain != nullptr && factor > 0.0) strain->shear[p][c] = 1.0 / factor;
      }
    }
  };
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) {
    ViscousPlane plane;
    plane.unpack(out, k);
    for (int j = 0; j < l.faceEnd(1); ++j) buildRow(l.index(0, j, k), j, k, plane);
    plane.pack(k, out);
  }
  out.forEachViscous([](RowField<float>& field) { field.shareImages(); });
  if (strain != nullptr) strain->fillHalos(l);
}

void buildFractionRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                       const StaggeredCoefficients<double>& coefficients, BodyRows& out) {
  out = BodyRows();
  buildDivergenceRows(grid, solids, bodies, coefficients, out);
  if (!coefficients.viscous) return;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    addStressRows(grid, solids.bodies[b], bodies[b], static_cast<int>(b), coefficients, out);
  }
}

void buildCoarseFractionLevels(const Lattice& lattice, const FractionGeometry& geometry,
                               const std::vector<double>& liquid_distance, double viscous_number, double least_number,
                               std::vector<StaggeredCoefficients<float>>& levels) {
  const bool viscous = viscous_number > 0.0;
  Lattice l = lattice;
  FractionGeometry g = geometry;
  std::vector<double> distance = liquid_distance;
  StaggeredCoefficients<double> coefficients;
  std::size_t count = 1;
  while (canCoarsen(l) && viscous_number > least_number) {
    const Lattice coarse = coarsened(l);
    std::vector<double> to;
    for (int a = 0; a < 3; ++a) {
      restrictFaces(l, a, g.fluid[a], coarse, to);
      fillHalo(coarse, to);
      g.fluid[a].swap(to);
    }
    if (viscous) {
      restrictCells(l, g.stress.cell, coarse, to);
      fillHalo(coarse, to);
      g.stress.cell.swap(to);
      edgesFromCells(coarse, g.stress);
    }
    restrictCells(l, distance, coarse, to);
    for (double& d : to) d *= 0.5;
    extendIntoHalo(coarse, to);
    distance.swap(to);
    sampleLiquidFractions(coarse, distance, viscous, g.liquid);
    viscous_number *= 0.25;
    l = coarse;
    buildFractionCoefficients(l, g, viscous_number, coefficients);
    if (levels.size() <= count) levels.resize(count + 1);
    convertCoefficients(coefficients, levels[count++]);
  }
  levels.resize(count);
}

}  // namespace monolith
