#include "coupling/stokes_coefficients.h"

#include <algorithm>
#include <cmath>

#include "coupling/fitted_segment.h"
#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

// A cell whose centre is less than this below the surface counts as dry: no face with a tiny part of liquid.
constexpr double kLeastLiquid = 1e-3;  // cell widths

bool isWet(double distance) { return distance < -kLeastLiquid; }
constexpr double kLeastSliver = 0.05;
constexpr double kDistanceCap = 2.5;   // cell widths; the fine distances are right at least up to here

// Liquid part of a cube of width one from the distance at its centre.
double liquidOfCube(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

class SampleBuilder {
 public:
  SampleBuilder(const Lattice& l, const StokesGeometry& g, const StaggeredCoefficients<double>& c)
      : lattice(l), geometry(g), coefficients(c) {}

  FaceKind kind(int axis, std::ptrdiff_t f) const {
    const bool solid = (*geometry.solid_distance)[axis][f] <= 0.0;
    if (coefficients.mass[axis][f] > 0.0) return solid ? FaceKind::kSliver : FaceKind::kFluid;
    return solid || (*geometry.fluid)[axis][f] <= 0.0 ? FaceKind::kSolid : FaceKind::kAir;
  }
  // Of component `axis`, from face a to the next along `along`.
  FittedSegment segment(int axis, std::ptrdiff_t a, int along) const {
    const auto b = a + lattice.stride[along];
    const auto& distance = (*geometry.solid_distance)[axis];
    const FaceKind kind_a = kind(axis, a), kind_b = kind(axis, b);
    const bool cut = isSolid(kind_a) != isSolid(kind_b);
    return fitSegment(kind_a, distance[a], kind_b, distance[b], cut ? sag(axis, a, along) : 0.0);
  }
  double liquidOfCell(std::ptrdiff_t c) const { return liquidOfCube((*geometry.liquid_distance)[c]); }
  double liquidOfEdge(std::ptrdiff_t c, int a, int b) const {
    const auto& d = *geometry.liquid_distance;
    const auto sa = lattice.stride[a];
    const auto sb = lattice.stride[b];
    return liquidOfCube(0.25 * (d[c] + d[c - sa] + d[c - sb] + d[c - sa - sb]));
  }

  const Lattice& lattice;
  const StokesGeometry& geometry;
  const StaggeredCoefficients<double>& coefficients;

 private:
  double sag(int axis, std::ptrdiff_t a, int along) const {
    if (geometry.solid_cell_distance == nullptr) return 0.0;
    const auto& cell = *geometry.solid_cell_distance;
    const auto& distance = *geometry.solid_distance;
    const auto b = a + lattice.stride[along];
    const double mean = 0.5 * (distance[axis][a] + distance[axis][b]);
    if (axis == along) return mean - cell[a];
    // Half way is an edge. The faces of the other component there, minus the cells around: what is left of the second
    // derivatives is that of the segment itself.
    const auto low = b - lattice.stride[axis];
    return 0.25 * (cell[a] + cell[b] + cell[low] + cell[low - lattice.stride[along]]) -
           0.5 * (distance[along][low] + distance[along][b]);
  }
};

// Beyond the walls: solid, half a cell from them. Along periodic axes the images.
void closeHalo(const Lattice& l, int face_axis, std::vector<double>& distance) {
  int end[3];
  for (int a = 0; a < 3; ++a) end[a] = a == face_axis ? l.faceEnd(a) : l.n[a];
  for (int k = -Lattice::kLowHalo; k < l.n[2] + Lattice::kHighHalo; ++k) {
    for (int j = -Lattice::kLowHalo; j < l.n[1] + Lattice::kHighHalo; ++j) {
      for (int i = -Lattice::kLowHalo; i < l.n[0] + Lattice::kHighHalo; ++i) {
        const bool inside = i >= 0 && i < end[0] && j >= 0 && j < end[1] && k >= 0 && k < end[2];
        if (!inside) distance[l.index(i, j, k)] = -0.5;
      }
    }
  }
  fillHalo(l, distance);
}

// Collects the rows of the bodies sample by sample.
class RowBuilder {
 public:
  RowBuilder(const SampleBuilder& samples, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
             const MacGrid& grid)
      : samples_(samples), solids_(solids), bodies_(bodies), grid_(grid) {}

  // The solid ends of a segment of component `axis` from face a at x_a to face b at x_b = x_a + h along `along`, as
  // they enter factor * (U_b - U_a).
  void addSegment(int axis, std::ptrdiff_t a, std::ptrdiff_t b, const Eigen::Vector3d& x_a, int along, double factor,
                  const FittedSegment& s, std::ptrdiff_t sample, std::vector<BodyRow>& out) const {
    Eigen::Vector3d x_b = x_a;
    x_b[along] += grid_.h;
    const bool solid_a = isSolid(samples_.kind(axis, a));
    const bool solid_b = isSolid(samples_.kind(axis, b));
    Eigen::Vector3d surface = x_a;
    if (!s.both_solid) surface[along] += (solid_a ? 1.0 - s.theta : s.theta) * grid_.h;
    if (solid_a) addEnd(axis, a, x_a, s.both_solid ? x_a : surface, -factor, sample, out);
    if (solid_b) addEnd(axis, b, x_b, s.both_solid ? x_b : surface, factor, sample, out);
  }

 private:
  // A solid end's velocity is the body's at `target`. A sliver's unknown already stands for it at the face itself.
  void addEnd(int axis, std::ptrdiff_t f, const Eigen::Vector3d& x_face, const Eigen::Vector3d& target, double factor,
              std::ptrdiff_t sample, std::vector<BodyRow>& out) const {
    const int owner = solids_.owner[axis][f];
    if (owner < 0) return;
    const Eigen::Vector3d& p_WBcm = bodies_[owner].p_WBcm;
    const Eigen::Vector3d shift = grid_.toNearestImage(x_face, p_WBcm);
    Vector6d row = velocityRow(axis, target + shift, p_WBcm);
    if (samples_.kind(axis, f) == FaceKind::kSliver) row -= velocityRow(axis, x_face + shift, p_WBcm);
    if (row.cwiseAbs().maxCoeff() == 0.0) return;
    out.push_back({sample, owner, factor * row});
  }

  const SampleBuilder& samples_;
  const SolidFractions& solids_;
  const std::vector<RigidBody>& bodies_;
  const MacGrid& grid_;
};

}  // namespace

double liquidPart(double distance_low, double distance_high) {
  const bool low = isWet(distance_low);
  const bool high = isWet(distance_high);
  if (low && high) return 1.0;
  if (!low && !high) return 0.0;
  const double wet = low ? distance_low : distance_high;
  const double dry = low ? distance_high : distance_low;
  // A dry cell may lie just below the surface: the part is then just above one, and liquid at rest stays so.
  return std::clamp(wet / (wet - dry), kLeastLiquid, 1.0 + 2.0 * kLeastLiquid);
}

void StrainScales::resize(const Lattice& l) {
  for (auto* fields : {&normal, &shear, &drag}) {
    for (auto& field : *fields) field.assign(l.size, 0.0);
  }
}

void StrainScales::fillHalos(const Lattice& l) {
  for (auto* fields : {&normal, &shear, &drag}) {
    for (auto& field : *fields) fillHalo(l, field);
  }
}

void buildCoefficients(const Lattice& l, const StokesGeometry& geometry, double viscous_number,
                       StaggeredCoefficients<double>& out, StrainScales* strain) {
  out.resize(l, viscous_number > 0.0);
  const auto& liquid = *geometry.liquid_distance;
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (auto f = row; f < row + width; ++f) {
      for (int a = 0; a < 3; ++a) {
        const double open = (*geometry.fluid)[a][f];
        const double mass = open * liquidPart(liquid[f - l.stride[a]], liquid[f]);
        if (!(mass > 0.0)) continue;
        out.mass[a][f] = mass;
        out.open[a][f] = open;
      }
    }
  });
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, out.mass[a]);
    fillHalo(l, out.open[a]);
  }
  const int end[3] = {l.n[0], l.n[1], l.n[2]};
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= end[1] || k >= end[2]) return;
    for (auto c = row; c < row + end[0]; ++c) {
      if (!isWet(liquid[c])) continue;
      double sum = 0.0;
      for (int a = 0; a < 3; ++a) sum += out.open[a][c] + out.open[a][c + l.stride[a]];
      out.has_pressure[c] = sum > 0.0;
    }
  });
  if (!out.viscous) return;

  if (strain != nullptr) strain->resize(l);
  const SampleBuilder samples(l, geometry, out);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (auto c = row; c < row + width; ++c) {
      for (int a = 0; a < 3; ++a) {
        const FittedSegment s = samples.segment(a, c, a);
        if (s.defined && !s.both_solid) {
          // eta |D_aa|^2: D^T D gives 2 N per unit weight; weight theta over theta^2.
          out.normal[a][c] = 2.0 * viscous_number * samples.liquidOfCell(c) / s.theta;
          if (strain != nullptr && out.normal[a][c] > 0.0) strain->normal[a][c] = 1.0 / s.theta;
        }
        if (samples.kind(a, c) == FaceKind::kSliver) {
          // The film between the face's open part and the surface is about half the open part thick.
          out.drag[a][c] = 4.0 * viscous_number / std::max(out.open[a][c], kLeastSliver);
          if (strain != nullptr) strain->drag[a][c] = 2.0 / std::max(out.open[a][c], kLeastSliver);
        }
      }
      for (int p = 0; p < 3; ++p) {
        const auto [a, b] = kShearPairs[p];
        const FittedSegment s = samples.segment(a, c - l.stride[b], b);
        const FittedSegment t = samples.segment(b, c - l.stride[a], a);
        if (!s.defined || !t.defined) continue;
        // eta 2 (1/2 (du + dv))^2, energy weight times N, its square root shared between the two differences.
        const auto& d = *geometry.solid_distance;
        const double share =
            shearWeight(s, t, d[a][c - l.stride[b]], d[a][c], d[b][c - l.stride[a]], d[b][c]);
        const double weight = std::sqrt(viscous_number * samples.liquidOfEdge(c, a, b) * share);
        out.shear[p][0][c] = weight / s.theta;
        out.shear[p][1][c] = weight / t.theta;
        if (strain != nullptr && weight > 0.0) strain->shear[p][c] = 1.0 / weight;
      }
    }
  });
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, out.normal[a]);
    fillHalo(l, out.drag[a]);
    for (int s = 0; s < 2; ++s) fillHalo(l, out.shear[a][s]);
  }
  if (strain != nullptr) strain->fillHalos(l);
}

void buildBodyRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                   const StokesGeometry& geometry, const StaggeredCoefficients<double>& coefficients, BodyRows& out) {
  const Lattice& l = grid.lattice;
  const double h = grid.h;
  out = BodyRows();

  buildDivergenceRows(grid, solids, bodies, coefficients, out);
  if (!coefficients.viscous) return;

  // J_s: every sample with an end in a body.
  const SampleBuilder samples(l, geometry, coefficients);
  const RowBuilder rows(samples, solids, bodies, grid);
  const int end_j = l.faceEnd(1);
  const int end_k = l.faceEnd(2);
  std::vector<BodyRows> slabs(end_k);
#pragma omp parallel for schedule(static)
  for (int k = 0; k < end_k; ++k) {
    BodyRows& slab = slabs[k];
    for (int j = 0; j < end_j; ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto c = l.index(i, j, k);
        // Nothing of a body within reach of the samples of this cell.
        if (solids.cell_distance[c] > 2.5) continue;
        for (int a = 0; a < 3; ++a) {
          const auto sa = l.stride[a];
          if (coefficients.normal[a][c] > 0.0) {
            const FittedSegment s = samples.segment(a, c, a);
            rows.addSegment(a, c, c + sa, grid.faceCenter(a, i, j, k), a, 1.0, s, c, slab.normal[a]);
          }
          if (coefficients.drag[a][c] > 0.0 && solids.owner[a][c] >= 0) {
            const int owner = solids.owner[a][c];
            const Eigen::Vector3d& p_WBcm = bodies[owner].p_WBcm;
            const Eigen::Vector3d x = grid.faceCenter(a, i, j, k);
            slab.drag[a].push_back({c, owner, velocityRow(a, x + grid.toNearestImage(x, p_WBcm), p_WBcm)});
          }
        }
        for (int p = 0; p < 3; ++p) {
          const auto [a, b] = kShearPairs[p];
          const auto sa = l.stride[a];
          const auto sb = l.stride[b];
          const double factor_a = coefficients.shear[p][0][c];
          const double factor_b = coefficients.shear[p][1][c];
          if (factor_a == 0.0 && factor_b == 0.0) continue;
          Eigen::Vector3d x_a = grid.faceCenter(a, i, j, k);
          x_a[b] -= h;
          Eigen::Vector3d x_b = grid.faceCenter(b, i, j, k);
          x_b[a] -= h;
          rows.addSegment(a, c - sb, c, x_a, b, factor_a, samples.segment(a, c - sb, b), c, slab.shear[p]);
          rows.addSegment(b, c - sa, c, x_b, a, factor_b, samples.segment(b, c - sa, a), c, slab.shear[p]);
        }
      }
    }
  }
  for (const BodyRows& slab : slabs) {
    for (int a = 0; a < 3; ++a) {
      out.normal[a].insert(out.normal[a].end(), slab.normal[a].begin(), slab.normal[a].end());
      out.shear[a].insert(out.shear[a].end(), slab.shear[a].begin(), slab.shear[a].end());
      out.drag[a].insert(out.drag[a].end(), slab.drag[a].begin(), slab.drag[a].end());
    }
  }
}

void buildCoarseLevels(const Lattice& lattice, const StokesGeometry& geometry, double viscous_number,
                       std::vector<StaggeredCoefficients<float>>& levels) {
  Lattice l = lattice;
  FaceField<double> fluid = *geometry.fluid;
  FaceField<double> distance = *geometry.solid_distance;
  std::vector<double> liquid = *geometry.liquid_distance;
  StaggeredCoefficients<double> coefficients;
  std::size_t count = 1;
  // Away from a body its distance is not known, only that it is large: cap it, or averages next to the body go wrong.
  for (auto& field : distance) {
    for (double& d : field) d = std::clamp(d, -kDistanceCap, kDistanceCap);
  }
  while (canCoarsen(l)) {
    const Lattice coarse = coarsened(l);
    for (int a = 0; a < 3; ++a) {
      std::vector<double> to;
      restrictFaces(l, a, fluid[a], coarse, to);
      fillHalo(coarse, to);
      fluid[a].swap(to);
      restrictFaces(l, a, distance[a], coarse, to);
      for (double& d : to) d *= 0.5;
      closeHalo(coarse, a, to);
      distance[a].swap(to);
    }
    std::vector<double> to;
    restrictCells(l, liquid, coarse, to);
    for (double& d : to) d *= 0.5;
    extendIntoHalo(coarse, to);
    liquid.swap(to);
    viscous_number *= 0.25;
    l = coarse;
    StokesGeometry g{&fluid, &distance, &liquid};
    buildCoefficients(l, g, viscous_number, coefficients);
    if (levels.size() <= count) levels.emplace_back();
    levels[count++] = convertCoefficients<float>(coefficients);
  }
  levels.resize(count);
}

}  // namespace monolith
