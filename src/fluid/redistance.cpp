// The level set made a distance again.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "fluid/free_surface.h"
#include "fluid/level_set.h"
#include "solve/marked_entries.h"
#include "solve/neighbours.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr int kThickestWall = 5;  // cells: what is thicker is a body, whose sides are the same surface
constexpr int kWayAround = 3;     // cells: so near to its edge a wall does not divide

// Solution of the discrete eikonal equation at a cell from its nearest neighbours along each axis, least <= middle <=
// most. Without branches, for the vector units.
inline double eikonal(double least, double middle, double most) {
  const double of_one = least + 1.0;
  const double difference = least - middle;
  const double of_two = 0.5 * (least + middle + std::sqrt(std::max(0.0, 2.0 - difference * difference)));
  const double sum = least + middle + most;
  const double squares = least * least + middle * middle + most * most;
  const double of_three = (sum + std::sqrt(std::max(0.0, sum * sum - 3.0 * (squares - 1.0)))) / 3.0;
  const double of_more = of_two > most ? of_three : of_two;
  return of_one > middle ? of_more : of_one;
}

// Of a row of cells.
struct Range {
  double least = kLevelSetFar, most = kLevelSetFar;
};

// Half a pass over a row of cells: those of one colour, every other one from `first` on, that are neither fixed nor
// settled. Around the row it reads the other colour only, which other threads do not write meanwhile.
Range relaxRow(const Lattice& l, std::ptrdiff_t row, int first, const std::uint8_t* fixed, double settled,
               std::vector<double>& field) {
  const int width = l.n[0], count = (width - first + 1) / 2;
  double* d = field.data() + row;
  thread_local std::vector<double> relaxed;
  relaxed.resize(count);
  double* next = relaxed.data();
  const double* of_colour = d + first;
  const std::uint8_t* is_fixed = fixed + row + first;
  const auto sy = l.stride[1], sz = l.stride[2];
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const double* at = of_colour + 2 * q;
    const double here = at[0];
    const double x = std::min(at[-1], at[1]), y = std::min(at[-sy], at[sy]), z = std::min(at[-sz], at[sz]);
    const double low = std::min(x, y), high = std::max(x, y);
    const double least = std::min(low, z), most = std::max(high, z), middle = std::max(low, std::min(high, z));
    const bool keeps = (is_fixed[2 * q] != 0) | (here <= settled) | (least >= kLevelSetBand);
    const double other = std::min(here, eikonal(least, middle, most));
    next[q] = keeps ? here : other;
  }
  for (int q = 0; q < count; ++q) d[first + 2 * q] = next[q];
  double least = kLevelSetFar, most = 0.0;
#pragma omp simd reduction(min : least) reduction(max : most)
  for (int i = 0; i < width; ++i) {
    least = std::min(least, d[i]);
    most = std::max(most, d[i]);
  }
  return {least, most};
}

// What the rows of a lattice hold.
class RowRanges {
 public:
  explicit RowRanges(const Lattice& l) : l_(l), ranges_(static_cast<std::size_t>(l.n[1]) * l.n[2]) {}

  Range& at(int j, int k) { return ranges_[j + static_cast<std::size_t>(l_.n[1]) * k]; }
  // Of a row and those beside it.
  double leastAround(int j, int k) const {
    double least = kLevelSetFar;
    for (const auto& [dj, dk] :
         {std::pair(0, 0), std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
      const int at_j = inside(j + dj, 1), at_k = inside(k + dk, 2);
      if (at_j >= 0 && at_k >= 0) {
        least = std::min(least, ranges_[at_j + static_cast<std::size_t>(l_.n[1]) * at_k].least);
      }
    }
    return least;
  }

 private:
  int inside(int at, int axis) const {
    at = l_.wrapped(axis, at);
    return at < l_.n[axis] ? at : -1;
  }

  const Lattice& l_;
  std::vector<Range> ranges_;
};

// Where solids are, for a surface that ends at them.
class SolidCells {
 public:
  // solid_distance at cells; empty: no solids.
  SolidCells(const Lattice& l, const std::vector<float>& solid_distance) : l_(l), distance_(solid_distance) {}

  // The tank's own walls are solid all the way.
  bool isSolid(std::array<int, 3> cell, int axis = 0, int steps = 0) const {
    if (distance_.empty()) return false;
    if (isBeyondTank(cell, axis, steps)) return true;
    cell[axis] = l_.wrapped(axis, cell[axis] + steps);
    return distance_[l_.index(cell[0], cell[1], cell[2])] <= 0.0F;
  }

  // Whether a cell and its neighbour lie in a wall, or one of them in a wall one cell thick, around which it is far
  // from one side to the other.
  bool areApart(const std::array<int, 3>& cell, int axis, int side) const {
    if (distance_.empty() || !(isSolid(cell) || isSolid(cell, axis, side))) return false;
    // Of the last cell before the wall and the first behind it, along the axis.
    int low = std::min(0, side), high = std::max(0, side);
    while (isSolid(cell, axis, low)) {
      if (high - --low > kThickestWall + 1 || isBeyondTank(cell, axis, low)) return false;
    }
    while (isSolid(cell, axis, high)) {
      if (++high - low > kThickestWall + 1 || isBeyondTank(cell, axis, high)) return false;
    }
    for (int b = 0; b < 3; ++b) {
      for (int away = -kWayAround; away <= kWayAround; ++away) {
        if (b == axis || away == 0 || isBeyondTank(cell, b, away)) continue;
        std::array<int, 3> beside = cell;
        beside[b] = l_.wrapped(b, cell[b] + away);
        bool open = true;
        for (int at = low; at <= high && open; ++at) open = !isSolid(beside, axis, at);
        if (open) return false;
      }
    }
    return true;
  }

 private:
  bool isBeyondTank(const std::array<int, 3>& cell, int axis, int steps) const {
    const int at = cell[axis] + steps;
    return !l_.periodic[axis] && (at < 0 || at >= l_.n[axis]);
  }

  const Lattice& l_;
  const std::vector<float>& distance_;
};

// How near to the surface a cell is. kNextAtSolid: it is solid, or its neighbour across the surface.
enum Nearness : std::uint8_t { kAway, kNext, kNextAtSolid };

// f(cell, {i, j, k}): for cells that lie on the other side of the surface than one of their neighbours.
template <class Function>
void forEachCrossed(const Lattice& l, const std::vector<double>& level_set, Function&& f) {
  const auto sy = l.stride[1], sz = l.stride[2];
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    thread_local RowMarks crossed;
    for (int j = 0; j < l.n[1]; ++j) {
      const auto row = l.index(0, j, k);
      const double* d = level_set.data() + row;
      std::uint8_t* mark = crossed.start(l.n[0]);
#pragma omp simd
      for (int i = 0; i < l.n[0]; ++i) {
        const bool in = d[i] < 0.0;
        mark[i] = (in != (d[i - 1] < 0.0)) | (in != (d[i + 1] < 0.0)) | (in != (d[i - sy] < 0.0)) |
                  (in != (d[i + sy] < 0.0)) | (in != (d[i - sz] < 0.0)) | (in != (d[i + sz] < 0.0));
      }
      crossed.forEach([&](std::ptrdiff_t i) { f(row + i, std::array<int, 3>{static_cast<int>(i), j, k}); });
    }
  }
}

// Cells next to the surface: the distance to the plane that the level set is there.
void measureNext(const Lattice& l, const std::vector<double>& level_set, const SolidCells& solids,
                 std::vector<std::uint8_t>& nearness, std::vector<double>& distance) {
  forEachCrossed(l, level_set, [&](std::ptrdiff_t c, const std::array<int, 3>& cell) {
    const double d = level_set[c];
    Nearness near = kAway;
    double slope2 = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double values[2] = {level_set[c - l.stride[a]], level_set[c + l.stride[a]]};
      bool cut[2] = {false, false}, wall[2] = {false, false};
      for (const int high : {0, 1}) {
        if ((d < 0.0) == (values[high] < 0.0)) continue;
        const int side = high == 1 ? 1 : -1;
        wall[high] = solids.areApart(cell, a, side);
        cut[high] = !wall[high];
        if (wall[high] || near == kNext) continue;
        near = solids.isSolid(cell) || solids.isSolid(cell, a, side) ? kNextAtSolid : kNext;
      }
      const double below = wall[0] ? 0.0 : d - values[0], above = wall[1] ? 0.0 : values[1] - d;
      // Across the surface where it is; central elsewhere.
      double slope = wall[0] || wall[1] ? below + above : 0.5 * (values[1] - values[0]);
      if (cut[0] && !cut[1]) slope = below;
      if (cut[1] && !cut[0]) slope = above;
      // A bubble or drop of one cell: its two sides cancel in the central difference.
      if (cut[0] && cut[1]) slope = std::max(std::abs(below), std::abs(above));
      slope2 += slope * slope;
    }
    if (near == kAway) return;
    distance[c] = std::abs(d) / std::max(std::sqrt(slope2), 0.1);
    nearness[c] = near;
  });
}

// What lies between liquid and a solid alone, or air and a solid, is no surface but a film thinner than half a cell,
// with no velocity of its own: it counts only where the surface ends at the solid.
void dropFilms(const Lattice& l, std::vector<std::uint8_t>& nearness, std::vector<double>& distance) {
  std::vector<std::vector<std::ptrdiff_t>> films(l.n[2]);  // by plane
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= l.n[1] || k >= l.n[2]) return;
    if (std::memchr(nearness.data() + row, kNextAtSolid, l.n[0]) == nullptr) return;
    for (auto c = row; c < row + l.n[0]; ++c) {
      if (nearness[c] != kNextAtSolid) continue;
      bool ends = false;
      forEachNeighbour(l, c, [&](std::ptrdiff_t next, int, int) { ends = ends || nearness[next] == kNext; });
      if (!ends) films[k].push_back(c);
    }
  });
  for (const auto& plane : films) {
    for (const auto c : plane) {
      distance[c] = kLevelSetFar;
      nearness[c] = kAway;
    }
  }
}

// From the cells next to the surface to those in the band. A cell's neighbours are all of the other colour, so each
// colour at once, by any number of threads. Information crosses a cell in each half-pass, and each adds 1/sqrt(3) at
// least to the distance.
void spread(const Lattice& l, const std::vector<std::uint8_t>& nearness, std::vector<double>& distance) {
  RowRanges ranges(l);
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= l.n[1] || k >= l.n[2]) return;
    const double* d = distance.data() + row;
    double least = kLevelSetFar;
#pragma omp simd reduction(min : least)
    for (int i = 0; i < l.n[0]; ++i) least = std::min(least, d[i]);
    ranges.at(j, k).least = least;
  });
  const int passes = static_cast<int>(std::ceil(kLevelSetBand * std::sqrt(3.0))) + 1;
  for (int pass = 0; pass < passes; ++pass) {
    const double settled = (pass - 1) / std::sqrt(3.0);
    fillHalo(l, distance);
    const RowRanges before = ranges;
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        // Rows that the surface has not reached yet, or in which all is settled.
        if (ranges.at(j, k).most <= settled || before.leastAround(j, k) >= kLevelSetBand) continue;
        ranges.at(j, k) = relaxRow(l, l.index(0, j, k), (j + k + pass) & 1, nearness.data(), settled, distance);
      }
    }
  }
}

}  // namespace

void FreeSurface::redistance(const std::vector<float>& solid_distance) {
  travelled_ = 0.0;
  const Lattice& l = grid_.lattice;
  std::vector<double>& next = scratch_.field;
  assignField(l.size, kLevelSetFar, next);
  assignZero(l.size, scratch_.nearness);
  measureNext(l, distance_, SolidCells(l, solid_distance), scratch_.nearness, next);
  dropFilms(l, scratch_.nearness, next);
  spread(l, scratch_.nearness, next);
#pragma omp parallel for simd schedule(static)
  for (std::size_t c = 0; c < l.size; ++c) next[c] = std::copysign(std::min(next[c], kLevelSetBand), distance_[c]);
  distance_.swap(next);
  extendIntoHalo(l, distance_);
}

}  // namespace monolith
