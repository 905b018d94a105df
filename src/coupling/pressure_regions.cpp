#include "coupling/pressure_regions.h"

#include <algorithm>
#include <map>

namespace monolith {

std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& c, const BodyRows& rows,
                                                const std::vector<char>& moves) {
  const Lattice& l = c.lattice;
  // Runs of connected cells along x, joined across the faces between rows (union-find).
  std::vector<int> run_of(l.size, -1);
  std::vector<int> parent;
  std::vector<char> open_to_air;
  const auto root = [&](int run) {
    while (parent[run] != run) run = parent[run] = parent[parent[run]];
    return run;
  };
  // The first run stands for the region: regions are numbered in the order of their first cells.
  const auto join = [&](int a, int b) {
    a = root(a);
    b = root(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  const auto forEachRowOfCells = [&](auto&& f) {
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) f(l.index(0, j, k), j, k);
    }
  };
  forEachRowOfCells([&](std::ptrdiff_t row, int, int) {
    for (auto cell = row; cell < row + l.n[0]; ++cell) {
      if (!c.has_pressure[cell]) continue;
      if (cell > row && run_of[cell - 1] >= 0 && c.open[0][cell] > 0.0) {
        run_of[cell] = run_of[cell - 1];
      } else {
        run_of[cell] = static_cast<int>(parent.size());
        parent.push_back(run_of[cell]);
      }
    }
  });
  open_to_air.assign(parent.size(), 0);
  forEachRowOfCells([&](std::ptrdiff_t row, int j, int k) {
    const int at[3] = {0, j, k};
    for (int a = 0; a < 3; ++a) {
      const auto s = l.stride[a];
      const auto around = s * l.n[a];
      // Across the low faces of this row, and the high ones of cells that the grid ends with.
      for (const int side : {0, 1}) {
        const bool ends = a == 0 || at[a] == l.n[a] - 1;
        if (side == 1 && (!ends || l.periodic[a])) continue;
        int before = -1, beside = -1;
        for (int i = 0; i < l.n[0]; ++i) {
          if (a == 0 && side == 1 && i + 1 < l.n[0]) continue;
          const auto cell = row + i;
          const auto face = side == 0 ? cell : cell + s;
          auto other = side == 0 ? cell - s : cell + s;
          if ((a == 0 ? i : at[a]) == 0 && side == 0 && l.periodic[a]) other += around;
          const int here = run_of[cell], there = run_of[other];
          if (here == there || !(c.open[a][face] > 0.0)) continue;
          if (here < 0 || there < 0) {
            open_to_air[std::max(here, there)] = 1;
          } else if (here != before || there != beside) {
            join(here, there);
            before = here;
            beside = there;
          }
        }
      }
    }
  });
  std::vector<int> id_of(parent.size(), -1);
  std::vector<PressureRegion> regions;
  for (std::size_t run = 0; run < parent.size(); ++run) {
    const int first = root(static_cast<int>(run));
    if (id_of[first] < 0) {
      id_of[first] = static_cast<int>(regions.size());
      regions.emplace_back();
      regions.back().sealed = true;
    }
    id_of[run] = id_of[first];
    if (open_to_air[run]) regions[id_of[run]].sealed = false;
  }
  forEachRowOfCells([&](std::ptrdiff_t row, int, int) {
    for (auto cell = row; cell < row + l.n[0]; ++cell) {
      if (run_of[cell] < 0) continue;
      PressureRegion& region = regions[id_of[run_of[cell]]];
      if (region.sealed) region.cells.push_back(cell);
    }
  });
  // The constant of a sealed region pushes a body by the sum of its rows there.
  std::map<std::pair<int, int>, std::pair<Vector6d, double>> push;  // region, body -> sum, size of its terms
  for (const BodyRow& row : rows.divergence) {
    const int run = run_of[row.sample];
    const int id = run < 0 ? -1 : id_of[run];
    if (id < 0 || !regions[id].sealed || !moves[row.body]) continue;
    auto& entry = push.try_emplace({id, row.body}, Vector6d::Zero(), 0.0).first->second;
    entry.first += row.coefficient;
    entry.second += row.coefficient.cwiseAbs().maxCoeff();
  }
  for (auto& region : regions) region.null_mode = region.sealed;
  for (const auto& [key, entry] : push) {
    if (entry.first.cwiseAbs().maxCoeff() > 1e-9 * entry.second) regions[key.first].null_mode = false;
  }
  return regions;
}

}  // namespace monolith
