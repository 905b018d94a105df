// The bodies' rows of the fitted gradient: buildBodyRows() of stokes_coefficients.h.

#include <cstring>

#include "coupling/stokes_samples.h"

namespace monolith {
namespace {

// Collects the rows of the bodies sample by sample.
class RowBuilder {
 public:
  RowBuilder(const SampleBuilder& samples, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
             const MacGrid& grid)
      : samples_(samples), solids_(solids), bodies_(bodies), grid_(grid) {}

  // The solid ends of a segment of component `axis` from face a at x_a to the next along `along`, as they enter
  // factor * (U_b - U_a).
  void addSegment(int axis, std::ptrdiff_t a, const Eigen::Vector3d& x_a, int along, double factor,
                  std::ptrdiff_t sample, std::vector<BodyRow>& out) const {
    const auto b = a + samples_.lattice.stride[along];
    const bool solid_a = isSolid(samples_.kind(axis, a));
    const bool solid_b = isSolid(samples_.kind(axis, b));
    if (!solid_a && !solid_b) return;
    const FittedSegment s = samples_.segment(axis, a, along);
    Eigen::Vector3d x_b = x_a;
    x_b[along] += grid_.h;
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
    const Eigen::Vector3d shift = toImageAt(bodies_[owner], grid_, x_face);
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

// Cells, and those beyond the last ones, from which the samples reach into the box of a body.
std::vector<char> nearBodies(const Lattice& l, const SolidFractions& solids) {
  std::vector<char> near(l.size, 0);
  const auto inside = [&](int at, int axis) {
    at = l.wrapped(axis, at);
    return at < l.faceEnd(axis) ? at : -1;
  };
  for (const BodyFractions& f : solids.bodies) {
    for (int dk = -1; dk <= f.count[2]; ++dk) {
      const int k = inside(f.low[2] + dk, 2);
      for (int dj = -1; k >= 0 && dj <= f.count[1]; ++dj) {
        const int j = inside(f.low[1] + dj, 1);
        if (j < 0) continue;
        for (int di = -1; di <= f.count[0]; ++di) {
          const int i = inside(f.low[0] + di, 0);
          if (i >= 0) near[l.index(i, j, k)] = 1;
        }
      }
    }
  }
  return near;
}

}  // namespace

void buildBodyRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                   const StokesGeometry& geometry, const StaggeredCoefficients<double>& coefficients,
                   const FaceKinds& kinds, BodyRows& out) {
  const Lattice& l = grid.lattice;
  const double h = grid.h;
  out = BodyRows();

  buildDivergenceRows(grid, solids, bodies, coefficients, out);
  if (!coefficients.viscous) return;

  // J_s: every sample with an end in a body.
  const SampleBuilder samples(l, geometry, kinds);
  const RowBuilder rows(samples, solids, bodies, grid);
  const int end_j = l.faceEnd(1);
  const int end_k = l.faceEnd(2);
  const int width = l.faceEnd(0);
  std::vector<BodyRows> slabs(end_k);
  const std::vector<char> near = nearBodies(l, solids);
  // Bodies may lie together in a few slabs.
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < end_k; ++k) {
    BodyRows& slab = slabs[k];
    std::vector<std::uint8_t> mark;
    for (int j = 0; j < end_j; ++j) {
      const auto row = l.index(0, j, k);
      if (std::memchr(near.data() + row, 1, width) == nullptr) continue;
      samples.markCells(row, width, mark);
      for (int i = 0; i < width; ++i) {
        const auto c = row + i;
        // Nothing of a body within reach of the samples of this cell.
        if (!near[c] || mark[i] != SampleBuilder::kMixed || solids.cell_distance[c] > 2.5f) continue;
        for (int a = 0; a < 3; ++a) {
          if (coefficients.normal[a][c] > 0.0) {
            rows.addSegment(a, c, grid.faceCenter(a, i, j, k), a, 1.0, c, slab.normal[a]);
          }
          if (coefficients.drag[a][c] > 0.0 && solids.owner[a][c] >= 0) {
            const int owner = solids.owner[a][c];
            const RigidBody& body = bodies[owner];
            const Eigen::Vector3d x = grid.faceCenter(a, i, j, k);
            slab.drag[a].push_back({c, owner, velocityRow(a, x + toImageAt(body, grid, x), body.p_WBcm)});
          }
        }
        for (int p = 0; p < 3; ++p) {
          const auto [a, b] = kShearPairs[p];
          const double factor_a = coefficients.shear[p][0][c];
          const double factor_b = coefficients.shear[p][1][c];
          if (factor_a == 0.0 && factor_b == 0.0) continue;
          Eigen::Vector3d x_a = grid.faceCenter(a, i, j, k);
          x_a[b] -= h;
          Eigen::Vector3d x_b = grid.faceCenter(b, i, j, k);
          x_b[a] -= h;
          rows.addSegment(a, c - l.stride[b], x_a, b, factor_a, c, slab.shear[p]);
          rows.addSegment(b, c - l.stride[a], x_b, a, factor_b, c, slab.shear[p]);
        }
      }
    }
  }
  appendRows(slabs, out);
}

}  // namespace monolith
