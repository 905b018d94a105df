#include "coupling/enclosed_rows.h"

#include <algorithm>
#include <array>

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

// Breadth-first from all cells with pressure into cells without, `inside` ones: for each the nearest cell with pressure,
// and the steps from there.
struct Nearest {
  std::vector<std::ptrdiff_t> cell;
  std::vector<Cell> steps;
};

// Index of the cell next to `at` along an axis, which is moved there; -1 beyond a wall.
std::ptrdiff_t step(const Lattice& l, Cell& at, int axis, int direction) {
  at[axis] += direction;
  if (l.periodic[axis]) at[axis] = (at[axis] + l.n[axis]) % l.n[axis];
  return at[axis] < 0 || at[axis] >= l.n[axis] ? -1 : l.index(at[0], at[1], at[2]);
}

Nearest findNearest(const Lattice& l, const std::vector<std::uint8_t>& has_pressure, const std::vector<char>& inside) {
  Nearest out;
  out.cell.assign(l.size, -1);
  out.steps.assign(l.size, Cell{0, 0, 0});
  std::vector<Cell> front;
  const auto hasWayIn = [&](const Cell& here) {
    for (int a = 0; a < 3; ++a) {
      for (const int direction : {-1, 1}) {
        Cell next = here;
        const auto n = step(l, next, a, direction);
        if (n >= 0 && inside[n] && !has_pressure[n]) return true;
      }
    }
    return false;
  };
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (!has_pressure[c]) continue;
        out.cell[c] = c;
        if (hasWayIn({i, j, k})) front.push_back({i, j, k});
      }
    }
  }
  for (std::size_t at = 0; at < front.size(); ++at) {
    const Cell here = front[at];
    const auto c = l.index(here[0], here[1], here[2]);
    for (int a = 0; a < 3; ++a) {
      for (const int direction : {-1, 1}) {
        Cell next = here;
        const auto n = step(l, next, a, direction);
        if (n < 0 || out.cell[n] >= 0 || !inside[n]) continue;
        out.cell[n] = out.cell[c];
        out.steps[n] = out.steps[c];
        out.steps[n][a] += direction;
        front.push_back(next);
      }
    }
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
  const Nearest along = findNearest(l, coefficients.has_pressure, contact);
  const auto hasNoRim = [&](const BodyRow& row) { return isBelowSurface(row) && along.cell[row.sample] < 0; };
  Nearest through;
  if (std::any_of(rows.enclosed.begin(), rows.enclosed.end(), hasNoRim)) {
    through = findNearest(l, coefficients.has_pressure, std::vector<char>(l.size, 1));
  }
  for (const BodyRow& row : rows.enclosed) {
    if (!isBelowSurface(row) || runsInPlace(bodies[row.body])) continue;
    const Nearest& nearest = hasNoRim(row) ? through : along;
    const auto q = nearest.cell[row.sample];
    if (q < 0) continue;
    rows.divergence.push_back({q, row.body, row.coefficient});
    const Cell& steps = nearest.steps[row.sample];
    weights.push_back({row.body, row.coefficient, grid.h * Eigen::Vector3d(steps[0], steps[1], steps[2])});
  }
  rows.enclosed.clear();
  return weights;
}

}  // namespace monolith
