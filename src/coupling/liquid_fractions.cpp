#include "coupling/liquid_fractions.h"

#include <algorithm>
#include <cmath>

#include "geometry/cube_fraction.h"

namespace monolith {
namespace {

// Beyond this the surface is outside the cell, also where the level set is not quite a distance.
constexpr double kReach = 2.0;  // cell widths

using Parts = std::array<double, 8>;  // by octant

// Continues the level set linearly beyond the walls: the surface goes straight on.
std::vector<double> continued(const Lattice& l, const std::vector<double>& distance) {
  std::vector<double> d = distance;
  for (int axis = 0; axis < 3; ++axis) {
    if (l.periodic[axis] || l.n[axis] < 2) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    const auto s = l.stride[axis];
    const int n = l.n[axis];
    for (int q = -Lattice::kLowHalo; q < l.n[c] + Lattice::kHighHalo; ++q) {
      for (int p = -Lattice::kLowHalo; p < l.n[b] + Lattice::kHighHalo; ++p) {
        double* row = d.data() + l.index(0, 0, 0) + p * l.stride[b] + q * l.stride[c];
        row[-s] = 2.0 * row[0] - row[s];
        row[n * s] = 2.0 * row[(n - 1) * s] - row[(n - 2) * s];
      }
    }
  }
  return d;
}

void cutCell(const Lattice& l, const std::vector<double>& d, std::ptrdiff_t c, Parts& out) {
  for (int o = 0; o < 8; ++o) {
    double value = 0.0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      auto at = c;
      double weight[3], slope[3];
      for (int a = 0; a < 3; ++a) {
        const int direction = ((o >> a) & 1) ? 1 : -1;
        const bool beyond = (corner >> a) & 1;
        if (beyond) at += direction * l.stride[a];
        weight[a] = beyond ? 0.25 : 0.75;
        slope[a] = beyond ? direction : -direction;
      }
      value += weight[0] * weight[1] * weight[2] * d[at];
      for (int a = 0; a < 3; ++a) gradient[a] += slope[a] * weight[(a + 1) % 3] * weight[(a + 2) % 3] * d[at];
    }
    out[o] = insideFraction(value / std::max(gradient.norm(), 1e-12), gradient, 0.5);
  }
}

// Mean over the octants, of the cells around a sample, that touch it and lie inside the tank. `axes`: those along which
// the sample lies between cells.
double mean(const Lattice& l, const std::vector<Parts>& octants, const int at[3], const int* axes, int count) {
  const auto c = l.index(at[0], at[1], at[2]);
  double sum = 0.0;
  int octants_inside = 0;
  for (int side = 0; side < (1 << count); ++side) {
    auto cell = c;
    int mask = 0, low = 0;
    bool inside = true;
    bool across[3] = {false, false, false};
    for (int q = 0; q < count; ++q) {
      const int a = axes[q];
      const int below = (side >> q) & 1;
      across[a] = true;
      mask |= 1 << a;
      low |= below << a;  // of the cell below, the high octants
      cell -= below * l.stride[a];
      inside = inside && (l.periodic[a] || (at[a] - below >= 0 && at[a] - below < l.n[a]));
    }
    for (int a = 0; a < 3; ++a) inside = inside && (across[a] || at[a] < l.n[a]);
    if (!inside) continue;
    for (int o = 0; o < 8; ++o) {
      if ((o & mask) != low) continue;
      sum += octants[cell][o];
      ++octants_inside;
    }
  }
  return octants_inside > 0 ? sum / octants_inside : 0.0;
}

}  // namespace

void sampleLiquidFractions(const Lattice& l, const std::vector<double>& distance, bool with_edges,
                           LiquidFractions& out) {
  const std::vector<double> d = continued(l, distance);
  std::vector<Parts> octants(l.size);
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    for (int i = 0; i < l.n[0]; ++i) {
      if (j >= l.n[1] || k >= l.n[2]) continue;
      Parts& parts = octants[row + i];
      if (std::abs(d[row + i]) > kReach) {
        parts.fill(d[row + i] < 0.0 ? 1.0 : 0.0);
      } else {
        cutCell(l, d, row + i, parts);
      }
    }
  });
  fillHalo(l, octants);
  out.cell.assign(l.size, 0.0);
  for (int a = 0; a < 3; ++a) out.face[a].assign(l.size, 0.0);
  for (int p = 0; p < 3; ++p) out.edge[p].assign(with_edges ? l.size : 0, 0.0);
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    for (int i = 0; i < l.faceEnd(0); ++i) {
      const int at[3] = {i, j, k};
      const auto c = row + i;
      if (std::abs(d[c]) > kReach + 2.0) {  // so are all cells around
        const double value = d[c] < 0.0 ? 1.0 : 0.0;
        out.cell[c] = value;
        for (int a = 0; a < 3; ++a) out.face[a][c] = value;
        for (auto& edge : out.edge) {
          if (with_edges) edge[c] = value;
        }
        continue;
      }
      out.cell[c] = mean(l, octants, at, nullptr, 0);
      for (int a = 0; a < 3; ++a) out.face[a][c] = mean(l, octants, at, &a, 1);
      for (int p = 0; with_edges && p < 3; ++p) out.edge[p][c] = mean(l, octants, at, kShearPairs[p], 2);
    }
  });
  fillHalo(l, out.cell);
  for (auto& field : out.face) fillHalo(l, field);
  for (auto& field : out.edge) {
    if (with_edges) fillHalo(l, field);
  }
}

}  // namespace monolith
