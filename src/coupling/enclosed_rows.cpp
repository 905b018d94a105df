#include "coupling/enclosed_rows.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "solve/neighbours.h"

namespace monolith {
namespace {

// What a cell without pressure takes from the nearest ones with it: as much from each of its neighbours that are a step
// nearer, so that what is symmetric stays so.
struct Share {
  std::vector<std::pair<std::ptrdiff_t, double>> cells;  // sorted; the parts sum to 1, none: there is no way
  Eigen::Vector3d steps = Eigen::Vector3d::Zero();       // from there, in the mean
};

void sortOnce(std::vector<std::ptrdiff_t>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

// Breadth-first from cells with pressure, on which it is 0, through those that `find` knows.
class Ways {
 public:
  static constexpr int kUnknown = -1;

  // find(n): the steps to cell n, kUnknown at first; null where no way leads through.
  Ways(const Lattice& l, const std::vector<std::uint8_t>& has_pressure, std::vector<std::ptrdiff_t> front,
       const std::function<int*(std::ptrdiff_t)>& find)
      : l_(l), has_pressure_(has_pressure), find_(find) {
    for (std::size_t at = 0; at < front.size(); ++at) {
      const int steps = stepsTo(front[at]);
      forEachNeighbour(l, front[at], [&](std::ptrdiff_t n, int, int) {
        int* known = has_pressure[n] ? nullptr : find(n);
        if (known == nullptr || *known != kUnknown) return;
        *known = steps + 1;
        front.push_back(n);
      });
    }
  }

  const Share& shareOf(std::ptrdiff_t cell) {
    const auto found = shares_.find(cell);
    if (found != shares_.end()) return found->second;
    Share share;
    const int steps = stepsTo(cell);
    if (steps == 0) {
      share.cells.emplace_back(cell, 1.0);
    } else if (steps != kUnknown) {
      std::map<std::ptrdiff_t, double> sum;
      int count = 0;
      forEachNeighbour(l_, cell, [&](std::ptrdiff_t n, int axis, int direction) {
        if (stepsTo(n) != steps - 1) return;
        const Share& next = shareOf(n);
        for (const auto& [from, part] : next.cells) sum[from] += part;
        share.steps += next.steps - direction * Eigen::Vector3d::Unit(axis);
        ++count;
      });
      for (const auto& [from, part] : sum) share.cells.emplace_back(from, part / count);
      share.steps /= count;
    }
    return shares_.emplace(cell, std::move(share)).first->second;
  }

 private:
  int stepsTo(std::ptrdiff_t cell) const {
    if (has_pressure_[cell]) return 0;
    const int* known = find_(cell);
    return known == nullptr ? kUnknown : *known;
  }

  const Lattice& l_;
  const std::vector<std::uint8_t>& has_pressure_;
  std::function<int*(std::ptrdiff_t)> find_;
  std::map<std::ptrdiff_t, Share> shares_;
};

// Cells with pressure next to one of `cells`.
std::vector<std::ptrdiff_t> rimOf(const Lattice& l, const std::vector<std::uint8_t>& has_pressure,
                                  const std::vector<std::ptrdiff_t>& cells) {
  std::vector<std::ptrdiff_t> rim;
  for (const auto c : cells) {
    forEachNeighbour(l, c, [&](std::ptrdiff_t n, int, int) {
      if (has_pressure[n]) rim.push_back(n);
    });
  }
  sortOnce(rim);
  return rim;
}

// All cells with pressure that have a neighbour without.
std::vector<std::ptrdiff_t> allRims(const Lattice& l, const std::vector<std::uint8_t>& has_pressure) {
  std::vector<std::ptrdiff_t> rims;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (!has_pressure[c]) continue;
        bool ends = false;
        forEachNeighbour(l, c, [&](std::ptrdiff_t n, int, int) { ends |= !has_pressure[n]; });
        if (ends) rims.push_back(c);
      }
    }
  }
  return rims;
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
  const auto& has_pressure = coefficients.has_pressure;
  std::vector<int> steps_along(contact.size(), Ways::kUnknown), steps_through;
  Ways along(l, has_pressure, rimOf(l, has_pressure, contact), [&](std::ptrdiff_t n) -> int* {
    const auto place = std::lower_bound(contact.begin(), contact.end(), n);
    return place == contact.end() || *place != n ? nullptr : &steps_along[place - contact.begin()];
  });
  std::optional<Ways> through;
  std::map<std::pair<std::ptrdiff_t, int>, Vector6d> moved;  // cell with pressure, body
  for (const BodyRow& row : rows.enclosed) {
    if (!isBelowSurface(row) || runsInPlace(bodies[row.body])) continue;
    const Share* share = &along.shareOf(row.sample);
    if (share->cells.empty()) {
      if (!through) {
        steps_through.assign(l.size, Ways::kUnknown);
        through.emplace(l, has_pressure, allRims(l, has_pressure), [&](std::ptrdiff_t n) { return &steps_through[n]; });
      }
      share = &through->shareOf(row.sample);
    }
    if (share->cells.empty()) continue;
    for (const auto& [cell, part] : share->cells) {
      moved.try_emplace({cell, row.body}, Vector6d::Zero()).first->second += part * row.coefficient;
    }
    weights.push_back({row.body, row.coefficient, grid.h * share->steps});
  }
  for (const auto& [key, coefficient] : moved) rows.divergence.push_back({key.first, key.second, coefficient});
  rows.enclosed.clear();
  return weights;
}

}  // namespace monolith
