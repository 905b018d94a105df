#include "coupling/stress_fractions.h"

#include <algorithm>

#include "coupling/octant_fractions.h"

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

// A cell whose centre is further than this from a surface is on one side of it.
constexpr double kReach = 0.87;  // cell widths, half the diagonal

// Index of a cell (pair < 0) or an edge, perhaps in a periodic image; -1 outside the tank.
std::ptrdiff_t sampleIndex(const Lattice& l, const Cell& at, int pair) {
  return pair < 0 ? l.indexInTank(at) : edgeIndex(l, pair, at);
}

// Every sample of a body's box, as f(local index, position in the grid).
template <class Function>
void forEachInBox(const BodyFractions& box, Function&& f) {
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < box.count[2]; ++k) {
    for (int j = 0; j < box.count[1]; ++j) {
      for (int i = 0; i < box.count[0]; ++i) {
        f(Cell{i, j, k}, Cell{box.low[0] + i, box.low[1] + j, box.low[2] + k});
      }
    }
  }
}

void sampleBody(const MacGrid& grid, const RigidBody& body, const BodyFractions& box, StressFractions& out) {
  const Lattice& l = grid.lattice;
  const std::size_t size = static_cast<std::size_t>(box.count[0]) * box.count[1] * box.count[2];
  out.cell.assign(size, 0.0);
  for (auto& field : out.edge) field.assign(size, 0.0);
  const Eigen::Isometry3d X_BW = body.pose().inverse();
  const Eigen::Matrix3d R_WB = body.pose().linear();
  std::vector<Octants> octants(size);
  forEachInBox(box, [&](const Cell& local, const Cell& at) {
    const std::size_t c = box.local(local[0], local[1], local[2]);
    octants[c].fill(0.0);
    if (l.indexInTank(at) < 0) return;
    const Eigen::Vector3d x_B = X_BW * grid.cellCenter(at[0], at[1], at[2]);
    const double distance = body.distance->distance(x_B) / grid.h;
    if (distance > kReach) return;
    if (distance < -kReach) {
      octants[c].fill(1.0);
    } else {
      octantFractions(*body.distance, x_B, R_WB, grid.h, octants[c]);
    }
    for (const double part : octants[c]) out.cell[c] += 0.125 * part;
  });
  forEachInBox(box, [&](const Cell& local, const Cell& at) {
    for (int p = 0; p < 3; ++p) {
      if (edgeIndex(l, p, at) < 0) continue;
      const auto [a, b] = kShearPairs[p];
      double sum = 0.0;
      for (int quarter = 0; quarter < 4; ++quarter) {
        Cell from = local;
        from[a] = box.within(a, from[a] - (quarter & 1));
        from[b] = box.within(b, from[b] - (quarter >> 1));
        if (from[a] < 0 || from[b] < 0) continue;
        const Octants& parts = octants[box.local(from[0], from[1], from[2])];
        // The octants of that cell which touch the edge: high ones of the cells below it.
        for (int o = 0; o < 8; ++o) {
          if (((o >> a) & 1) == (quarter & 1) && ((o >> b) & 1) == (quarter >> 1)) sum += 0.125 * parts[o];
        }
      }
      out.edge[p][box.local(local[0], local[1], local[2])] = sum;
    }
  });
}

// One kind of sample: `fluid` holds the part of each that lies in the tank, and is left with what the bodies do not
// take. Where they overlap they share.
void share(const Lattice& l, int pair, const SolidFractions& solids, const std::vector<std::vector<double>*>& parts,
           std::vector<double>& fluid) {
  std::vector<double> solid(l.size, 0.0);
  const auto visit = [&](auto&& f) {
    for (std::size_t b = 0; b < parts.size(); ++b) {
      const BodyFractions& box = solids.bodies[b];
      for (int k = 0; k < box.count[2]; ++k) {
        for (int j = 0; j < box.count[1]; ++j) {
          for (int i = 0; i < box.count[0]; ++i) {
            double& part = (*parts[b])[box.local(i, j, k)];
            if (part > 0.0) f(sampleIndex(l, {box.low[0] + i, box.low[1] + j, box.low[2] + k}, pair), part);
          }
        }
      }
    }
  };
  visit([&](std::ptrdiff_t g, double& part) { solid[g] += part; });
  visit([&](std::ptrdiff_t g, double& part) {
    if (solid[g] > fluid[g]) part *= fluid[g] / solid[g];
  });
  for (std::size_t g = 0; g < l.size; ++g) fluid[g] = std::max(0.0, fluid[g] - solid[g]);
  fillHalo(l, fluid);
}

// Fills in the parts that lie in the tank, without bodies.
void emptyTank(const Lattice& l, StressFractions& out) {
  out.cell.assign(l.size, 0.0);
  for (auto& field : out.edge) field.assign(l.size, 0.0);
  for (int k = 0; k < l.faceEnd(2); ++k) {
    for (int j = 0; j < l.faceEnd(1); ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto c = l.index(i, j, k);
        if (i < l.n[0] && j < l.n[1] && k < l.n[2]) out.cell[c] = 1.0;
        for (int p = 0; p < 3; ++p) out.edge[p][c] = edgeInTank(l, p, {i, j, k});
      }
    }
  }
}

}  // namespace

double edgeInTank(const Lattice& l, int pair, const std::array<int, 3>& at) {
  if (edgeIndex(l, pair, at) < 0) return 0.0;
  double part = 1.0;
  for (const int a : kShearPairs[pair]) {
    if (!l.periodic[a] && (at[a] == 0 || at[a] == l.n[a])) part *= 0.5;
  }
  return part;
}

void sampleStressFractions(const MacGrid& grid, const std::vector<RigidBody>& bodies, const SolidFractions& solids,
                           StressFractions& fluid, std::vector<StressFractions>& parts) {
  const Lattice& l = grid.lattice;
  emptyTank(l, fluid);
  parts.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) sampleBody(grid, bodies[b], solids.bodies[b], parts[b]);
  std::vector<std::vector<double>*> of_bodies(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) of_bodies[b] = &parts[b].cell;
  share(l, -1, solids, of_bodies, fluid.cell);
  for (int p = 0; p < 3; ++p) {
    for (std::size_t b = 0; b < bodies.size(); ++b) of_bodies[b] = &parts[b].edge[p];
    share(l, p, solids, of_bodies, fluid.edge[p]);
  }
}

void edgesFromCells(const Lattice& l, StressFractions& fluid) {
  for (int p = 0; p < 3; ++p) {
    const auto [a, b] = kShearPairs[p];
    const auto sa = l.stride[a];
    const auto sb = l.stride[b];
    fluid.edge[p].assign(l.size, 0.0);
    const auto& cell = fluid.cell;
    auto& edge = fluid.edge[p];
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto e = row; e < row + l.faceEnd(0); ++e) {
        edge[e] = 0.25 * (cell[e] + cell[e - sa] + cell[e - sb] + cell[e - sa - sb]);
      }
    });
    fillHalo(l, edge);
  }
}

}  // namespace monolith
