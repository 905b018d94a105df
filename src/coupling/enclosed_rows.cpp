#include "coupling/enclosed_rows.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

// The nearest cell with pressure, and the steps from there; of cells without pressure.
struct Way {
  std::ptrdiff_t cell;
  Cell steps;
};
using Nearest = std::unordered_map<std::ptrdiff_t, Way>;

// Index of the cell next to `at` along an axis, which is moved there; -1 beyond a wall.
std::ptrdiff_t step(const Lattice& l, Cell& at, int axis, int direction) {
  at[axis] += direction;
  if (l.periodic[axis]) at[axis] = (at[axis] + l.n[axis]) % l.n[axis];
  return at[axis] < 0 || at[axis] >= l.n[axis] ? -1 : l.index(at[0], at[1], at[2]);
}

std::vector<Cell> cellsOf(const Lattice& l, const std::vector<char>& mask) {
  std::vector<Cell> cells;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      const char* row = mask.data() + l.index(0, j, k);
      for (int i = 0; i < l.n[0]; ++i) {
        if (row[i]) cells.push_back({i, j, k});
      }
    }
  }
  return cells;
}

// Breadth first from the cells with pressure, in order, into the cells of `inside` that have none.
template <class IsInside>
Nearest findNearest(const Lattice& l, const std::vector<std::uint8_t>& has_pressure, const std::vector<Cell>& inside,
                    const IsInside& isInside) {
  Nearest out;
  const auto forEachNeighbour = [&](const Cell& here, auto&& f) {
    for (int a = 0; a < 3; ++a) {
      for (const int direction : {-1, 1}) {
        Cell next = here;
        const auto n = step(l, next, a, direction);
        if (n >= 0) f(n, next, a, direction);
      }
    }
  };
  std::map<std::ptrdiff_t, Cell> ways_in;
  for (const Cell& cell : inside) {
    if (has_pressure[l.index(cell[0], cell[1], cell[2])]) continue;
    forEachNeighbour(cell, [&](std::ptrdiff_t n, const Cell& next, int, int) {
      if (has_pressure[n]) ways_in.emplace(n, next);
    });
  }
  std::vector<Cell> front;
  for (const auto& [cell, at] : ways_in) {
    front.push_back(at);
    out[cell] = {cell, {0, 0, 0}};
  }
  for (std::size_t at = 0; at < front.size(); ++at) {
    const Cell here = front[at];
    const Way from = out[l.index(here[0], here[1], here[2])];
    forEachNeighbour(here, [&](std::ptrdiff_t n, const Cell& next, int axis, int direction) {
      if (has_pressure[n] || !isInside(n)) return;
      const auto [entry, fresh] = out.try_emplace(n, from);
      if (!fresh) return;
      entry->second.steps[axis] += direction;
      front.push_back(next);
    });
  }
  return out;
}

// A belt opens nothing: what leaves on one side comes from the wall or body behind it on the other.
bool runsInPlace(const RigidBody& body) { return body.motion == BodyMotion::kPrescribed && body.prescribed.in_place; }

}  // namespace

std::vector<EnclosedWeight> moveEnclosedRows(const MacGrid& grid, const SolidFractions& solids,
                                             const std::vector<RigidBody>& bodies,
                                             const StaggeredCoefficients<double>& coefficients,
                                             const std::vector<double>& liquid_distance, BodyRows& rows) {
  std::vector<EnclosedWeight> weights;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (const WallPart& part : solids.bodies[b].at_walls) {
      if (!(liquid_distance[part.cell] < 0.0)) continue;
      weights.push_back({static_cast<int>(b), part.fraction * velocityRow(part.axis, part.position, bodies[b].p_WBcm),
                         -grid.h * Eigen::Vector3d::Unit(part.axis)});
    }
  }
  if (rows.enclosed.empty()) return weights;
  const Lattice& l = grid.lattice;
  const auto isBelowSurface = [&](const BodyRow& row) { return liquid_distance[row.sample] < 0.0; };
  if (std::none_of(rows.enclosed.begin(), rows.enclosed.end(), isBelowSurface)) {
    rows.enclosed.clear();
    return weights;
  }
  // Along the contact first: through a body only if the contact has no rim.
  std::vector<char> contact(l.size, 0);
  for (const BodyRow& row : rows.enclosed) contact[row.sample] = 1;
  const Nearest along = findNearest(l, coefficients.has_pressure, cellsOf(l, contact),
                                    [&](std::ptrdiff_t cell) { return contact[cell] != 0; });
  const auto hasNoRim = [&](const BodyRow& row) { return isBelowSurface(row) && along.count(row.sample) == 0; };
  Nearest through;
  if (std::any_of(rows.enclosed.begin(), rows.enclosed.end(), hasNoRim)) {
    through = findNearest(l, coefficients.has_pressure, cellsOf(l, std::vector<char>(l.size, 1)),
                          [](std::ptrdiff_t) { return true; });
  }
  for (const BodyRow& row : rows.enclosed) {
    if (!isBelowSurface(row) || runsInPlace(bodies[row.body])) continue;
    const Nearest& nearest = hasNoRim(row) ? through : along;
    const auto found = nearest.find(row.sample);
    if (found == nearest.end()) continue;
    const Way& way = found->second;
    rows.divergence.push_back({way.cell, row.body, row.coefficient});
    weights.push_back(
        {row.body, row.coefficient, grid.h * Eigen::Vector3d(way.steps[0], way.steps[1], way.steps[2])});
  }
  rows.enclosed.clear();
  return weights;
}

}  // namespace monolith
