#include "coupling/enclosed_rows.h"

#include <algorithm>
#include <array>
#include <utility>

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

// The cell with pressure that is nearest to one without, and the steps from there.
struct Nearest {
  std::ptrdiff_t cell = -1;  // -1: none
  Cell steps = {0, 0, 0};
};

// f(cell, axis, direction): for the neighbours of a cell in the tank.
template <class Function>
void forEachNeighbour(const Lattice& l, std::ptrdiff_t cell, Function&& f) {
  const Cell here = l.cell(cell);
  for (int a = 0; a < 3; ++a) {
    for (const int direction : {-1, 1}) {
      Cell at = here;
      at[a] += direction;
      if (l.periodic[a]) at[a] = (at[a] + l.n[a]) % l.n[a];
      if (at[a] >= 0 && at[a] < l.n[a]) f(l.index(at[0], at[1], at[2]), a, direction);
    }
  }
}

void sortOnce(std::vector<std::ptrdiff_t>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

// Breadth-first from cells with pressure, in the lattice's order. find(n): what is known of cell n; null where the
// search may not go.
template <class Find>
void spread(const Lattice& l, std::vector<std::ptrdiff_t> front, Find&& find) {
  std::vector<Nearest> from;
  for (const auto c : front) from.push_back({c});
  for (std::size_t at = 0; at < front.size(); ++at) {
    forEachNeighbour(l, front[at], [&](std::ptrdiff_t n, int axis, int direction) {
      Nearest* nearest = find(n);
      if (nearest == nullptr || nearest->cell >= 0) return;
      *nearest = from[at];
      nearest->steps[axis] += direction;
      front.push_back(n);
      from.push_back(*nearest);
    });
  }
}

// Of the cells of a contact, which are sorted, by ways that lead through them only.
std::vector<Nearest> nearestAlong(const Lattice& l, const std::vector<std::uint8_t>& has_pressure,
                                  const std::vector<std::ptrdiff_t>& contact) {
  std::vector<std::ptrdiff_t> rim;
  for (const auto c : contact) {
    forEachNeighbour(l, c, [&](std::ptrdiff_t n, int, int) {
      if (has_pressure[n]) rim.push_back(n);
    });
  }
  sortOnce(rim);
  std::vector<Nearest> out(contact.size());
  spread(l, std::move(rim), [&](std::ptrdiff_t n) -> Nearest* {
    const auto place = std::lower_bound(contact.begin(), contact.end(), n);
    return place == contact.end() || *place != n ? nullptr : &out[place - contact.begin()];
  });
  return out;
}

// Of all cells without pressure.
std::vector<Nearest> nearestThrough(const Lattice& l, const std::vector<std::uint8_t>& has_pressure) {
  std::vector<Nearest> out(l.size);
  std::vector<std::ptrdiff_t> front;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (!has_pressure[c]) continue;
        out[c].cell = c;
        bool ends = false;
        forEachNeighbour(l, c, [&](std::ptrdiff_t n, int, int) { ends |= !has_pressure[n]; });
        if (ends) front.push_back(c);
      }
    }
  }
  spread(l, std::move(front), [&](std::ptrdiff_t n) { return &out[n]; });
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
  std::vector<std::ptrdiff_t> contact;
  for (const BodyRow& row : rows.enclosed) contact.push_back(row.sample);
  sortOnce(contact);
  const std::vector<Nearest> along = nearestAlong(l, coefficients.has_pressure, contact);
  std::vector<Nearest> through;
  for (const BodyRow& row : rows.enclosed) {
    if (!isBelowSurface(row) || runsInPlace(bodies[row.body])) continue;
    Nearest nearest = along[std::lower_bound(contact.begin(), contact.end(), row.sample) - contact.begin()];
    if (nearest.cell < 0) {
      if (through.empty()) through = nearestThrough(l, coefficients.has_pressure);
      nearest = through[row.sample];
    }
    if (nearest.cell < 0) continue;
    rows.divergence.push_back({nearest.cell, row.body, row.coefficient});
    const Eigen::Vector3d steps(nearest.steps[0], nearest.steps[1], nearest.steps[2]);
    weights.push_back({row.body, row.coefficient, grid.h * steps});
  }
  rows.enclosed.clear();
  return weights;
}

}  // namespace monolith
