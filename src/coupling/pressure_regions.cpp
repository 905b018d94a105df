#include "coupling/pressure_regions.h"

#include <map>

namespace monolith {

std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& c, const BodyRows& rows,
                                                const std::vector<char>& moves) {
  const Lattice& l = c.lattice;
  std::vector<int> region_of(l.size, -1);
  std::vector<PressureRegion> regions;
  std::vector<std::ptrdiff_t> stack;
  // Index of the cell across a face, through periodic images.
  const auto neighbour = [&](std::ptrdiff_t cell, int axis, int direction) {
    auto next = cell + direction * l.stride[axis];
    if (l.periodic[axis]) {
      const auto along = (cell / l.stride[axis]) % (axis < 2 ? l.stride[axis + 1] / l.stride[axis] : l.n[2] + 3);
      const auto position = along - Lattice::kLowHalo;
      if (position + direction < 0) next += l.n[axis] * l.stride[axis];
      if (position + direction >= l.n[axis]) next -= l.n[axis] * l.stride[axis];
    }
    return next;
  };
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto seed = l.index(i, j, k);
        if (!c.has_pressure[seed] || region_of[seed] >= 0) continue;
        const int id = static_cast<int>(regions.size());
        PressureRegion region;
        region.sealed = true;
        region_of[seed] = id;
        stack.assign(1, seed);
        while (!stack.empty()) {
          const auto cell = stack.back();
          stack.pop_back();
          region.cells.push_back(cell);
          for (int a = 0; a < 3; ++a) {
            for (int direction : {-1, 1}) {
              const auto face = direction < 0 ? cell : cell + l.stride[a];
              if (!(c.open[a][face] > 0.0)) continue;
              const auto next = neighbour(cell, a, direction);
              if (!c.has_pressure[next]) {
                region.sealed = false;
              } else if (region_of[next] < 0) {
                region_of[next] = id;
                stack.push_back(next);
              }
            }
          }
        }
        if (!region.sealed) region.cells.clear();
        regions.push_back(std::move(region));
      }
    }
  }
  // The constant of a sealed region pushes a body by the sum of its rows there.
  std::map<std::pair<int, int>, std::pair<Vector6d, double>> push;  // region, body -> sum, size of its terms
  for (const BodyRow& row : rows.divergence) {
    const int id = region_of[row.sample];
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
