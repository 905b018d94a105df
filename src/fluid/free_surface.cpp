#include "fluid/free_surface.h"

#include <algorithm>
#include <cmath>

#include "fluid/advection.h"
#include "fluid/interpolation.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kFar = 1e3;               // cell widths
constexpr double kTravelToRedistance = 1.0;  // cells
// Half-width, in cells, of the band around the surface in which the level set is a distance; beyond it is just as large
// as that, which is further than anyone looks.
constexpr double kBand = 6.0;
constexpr double kLongestWay = kBand - 1.0;  // cells in one advection, kTravelToRedistance being undone before the next
// Cells: a box of liquid whose face is so far within a solid or before it ends at the solid.
constexpr double kDeepestFace = 0.5, kFarthestFace = 0.01;
constexpr int kThickestWall = 5;             // cells: what is thicker is a body, whose sides are the same surface
constexpr int kWayAround = 3;                // cells: so near to its edge a wall does not divide
constexpr double kClearSlope = 1.0;          // of the distance from a solid, over two cells: half of what it is
constexpr double kSampleBeyondSolid = 0.75;  // cells: outside, where the value is the liquid's own
constexpr double kSlopeBeyondFoot = 1.0;     // cells: further out, where the slope is

// Solution of the discrete eikonal equation at a cell from its nearest neighbours along each axis.
double eikonal(std::array<double, 3> d) {
  std::sort(d.begin(), d.end());
  double x = d[0] + 1.0;
  if (x > d[1]) {
    x = 0.5 * (d[0] + d[1] + std::sqrt(std::max(0.0, 2.0 - (d[0] - d[1]) * (d[0] - d[1]))));
    if (x > d[2]) {
      const double sum = d[0] + d[1] + d[2];
      const double squares = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      x = (sum + std::sqrt(std::max(0.0, sum * sum - 3.0 * (squares - 1.0)))) / 3.0;
    }
  }
  return x;
}

// Of a row of cells.
struct Range {
  double least = kFar, most = kFar;
};

// Half a pass over a row of cells: those of one colour, every other one from `first` on, that are neither fixed nor
// settled. Around the row it reads the other colour only, which other threads do not write meanwhile.
Range relaxRow(const Lattice& l, std::ptrdiff_t row, int first, const std::uint8_t* fixed, double settled,
               std::vector<double>& field) {
  const int width = l.n[0];
  double* d = field.data() + row;
  for (int i = first; i < width; i += 2) {
    if (fixed[row + i] || d[i] <= settled) continue;
    std::array<double, 3> nearest;
    for (int a = 0; a < 3; ++a) nearest[a] = std::min(d[i - l.stride[a]], d[i + l.stride[a]]);
    if (std::min({nearest[0], nearest[1], nearest[2]}) >= kBand) continue;
    d[i] = std::min(d[i], eikonal(nearest));
  }
  double least = kFar, most = 0.0;
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
    double least = kFar;
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
    if (l_.periodic[axis]) return (at + l_.n[axis]) % l_.n[axis];
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
    cell[axis] = wrapped(axis, cell[axis] + steps);
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
        beside[b] = wrapped(b, cell[b] + away);
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
  int wrapped(int axis, int at) const { return (at % l_.n[axis] + l_.n[axis]) % l_.n[axis]; }

  const Lattice& l_;
  const std::vector<float>& distance_;
};

// How near to the surface a cell is. kNextAtSolid: its neighbour across is solid, or it is.
enum Nearness : std::uint8_t { kAway, kNext, kNextAtSolid };

}  // namespace

FreeSurface::FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
                         const std::function<double(const Eigen::Vector3d&)>& solid_distance)
    : grid_(grid) {
  const Lattice& l = grid.lattice;
  distance_.assign(l.size, kFar);
  const double top = grid.size()[2];
  const bool by_level = fill_height > 0.0;
  struct Filled {
    Eigen::AlignedBox3d box;
    bool by_level;
  };
  std::vector<Filled> all;
  for (const Eigen::AlignedBox3d& box : boxes) all.push_back({box, false});
  if (by_level) {
    const Eigen::Vector3d top_corner(grid.size()[0], grid.size()[1], fill_height);
    all.push_back({Eigen::AlignedBox3d(grid.origin, grid.origin + top_corner), true});
  }
  // With the periodic images next to the tank.
  for (int a = 0; a < 3; ++a) {
    if (!l.periodic[a]) continue;
    const Eigen::Vector3d period = grid.size()[a] * Eigen::Vector3d::Unit(a);
    for (std::size_t box = 0, own = all.size(); box < own; ++box) {
      for (const Eigen::Vector3d& shift : {Eigen::Vector3d(-period), period}) {
        all.push_back({all[box].box.translated(shift), all[box].by_level});
      }
    }
  }
  const auto isCovered = [&](const Eigen::Vector3d& x) {
    return std::any_of(all.begin(), all.end(), [&](const Filled& filled) { return filled.box.contains(x); });
  };
  const auto onSolid = [&](const Eigen::Vector3d& x) {
    if (!solid_distance) return false;
    const double distance = solid_distance(x);
    return distance > -kDeepestFace && distance < kFarthestFace;
  };
  // A box's faces on the tank's walls do not bound the liquid, what is beyond them never counts; nor do its faces where
  // they meet other liquid or lie on a solid.
  const auto boxDistance = [&](const Eigen::Vector3d& x, const Filled& filled, bool within) {
    const Eigen::AlignedBox3d& box = filled.box;
    const double nudge = 1e-9 * grid.h;
    Eigen::Vector3d outside = Eigen::Vector3d::Zero();
    double inside = -kFar;
    for (int a = 0; a < 3; ++a) {
      for (const int side : {-1, 1}) {
        const double at = side < 0 ? box.min()[a] : box.max()[a];
        const double wall = grid.origin[a] + (side < 0 ? 0.0 : grid.size()[a]);
        if (!l.periodic[a] && side * (wall - at) <= nudge) continue;
        Eigen::Vector3d foot = x;
        foot[a] = at + side * nudge;
        if (within && (isCovered(foot) || (!filled.by_level && onSolid(foot)))) continue;
        const double d = side * (x[a] - at) / grid.h;
        outside[a] = std::max(outside[a], d);
        inside = std::max(inside, d);
      }
    }
    if (within) return inside;
    const Eigen::Vector3d nearest = x.cwiseMax(box.min()).cwiseMin(box.max());
    const bool behind_wall = !filled.by_level && onSolid(nearest) && solid_distance(x) > 0.0;
    return behind_wall ? kBand : outside.norm();
  };
  // Each of the faces is at most as near as the surface: the nearest counts, of the boxes around a point or, outside, of
  // all.
  const auto unionDistance = [&](const Eigen::Vector3d& x) {
    double in = -kFar, out = kFar;
    for (const Filled& filled : all) {
      const bool within = filled.box.contains(x);
      const double d = boxDistance(x, filled, within);
      (within ? in : out) = within ? std::max(in, d) : std::min(out, d);
    }
    return in > -kFar ? in : isCovered(x) ? -kBand : out;
  };
  full_ = true;
  empty_ = true;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const Eigen::Vector3d x = grid.cellCenter(i, j, k);
        const double d = unionDistance(x);
        distance_[l.index(i, j, k)] = d;
        full_ = full_ && d <= -0.5;
        empty_ = empty_ && d >= 0.0;
      }
    }
  }
  // A tank filled to within half a cell of its lid still has a surface unless it is filled to the lid.
  if (by_level && fill_height < top * (1.0 - 1e-12) && boxes.empty()) full_ = false;
  extendIntoHalo(l, distance_);
}

FreeSurface& FreeSurface::operator=(const FreeSurface& other) {
  grid_ = other.grid_;
  full_ = other.full_;
  empty_ = other.empty_;
  travelled_ = other.travelled_;
  copyField(other.distance_, distance_);
  pools_ = other.pools_;
  return *this;
}

void FreeSurface::advect(const FaceField<double>& velocity, double dt, double maximum_speed,
                         const std::vector<float>& solid_distance) {
  if (full_ || empty_ || maximum_speed == 0.0) return;
  // Only in the band does the level set tell where the surface is: a way that is longer is gone in parts, but not in
  // more than lead through the whole tank.
  const double cells = maximum_speed * dt / grid_.h;
  const auto& n = grid_.lattice.n;
  const int parts = static_cast<int>(std::ceil(std::clamp<double>(cells, 1.0, n[0] + n[1] + n[2]) / kLongestWay));
  for (int part = 0; part < parts; ++part) {
    advectCells(grid_, velocity, distance_, dt / parts, kBand, scratch_.field);
    distance_.swap(scratch_.field);
    extendIntoHalo(grid_.lattice, distance_);
    travelled_ += cells / parts;
    if (travelled_ > kTravelToRedistance) redistance(solid_distance);
  }
}

void FreeSurface::redistance(const std::vector<float>& solid_distance) {
  travelled_ = 0.0;
  const Lattice& l = grid_.lattice;
  const SolidCells solids(l, solid_distance);
  std::vector<double>& next = scratch_.field;
  assignField(l.size, kFar, next);
  std::vector<std::uint8_t>& fixed = scratch_.fixed;
  assignZero(l.size, fixed);
  RowRanges ranges(l);
  const auto forEachCell = [&](auto&& f) {
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) f(l.index(i, j, k), std::array<int, 3>{i, j, k});
      }
    }
  };
  // Next to the surface: the distance to the plane that the level set is there.
  forEachCell([&](std::ptrdiff_t c, const std::array<int, 3>& cell) {
    const double d = distance_[c];
    Nearness nearness = kAway;
    double slope2 = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double values[2] = {distance_[c - l.stride[a]], distance_[c + l.stride[a]]};
      bool cut[2] = {false, false}, wall[2] = {false, false};
      for (const int high : {0, 1}) {
        if ((d < 0.0) == (values[high] < 0.0)) continue;
        const int side = high == 1 ? 1 : -1;
        wall[high] = solids.areApart(cell, a, side);
        cut[high] = !wall[high];
        if (!cut[high] || nearness == kNext) continue;
        nearness = solids.isSolid(cell) || solids.isSolid(cell, a, side) ? kNextAtSolid : kNext;
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
    if (nearness == kAway) return;
    next[c] = std::abs(d) / std::max(std::sqrt(slope2), 0.1);
    fixed[c] = nearness;
  });
  // What lies between liquid and a solid alone, or air and a solid, is no surface but a film thinner than half a cell,
  // with no velocity of its own: it counts only where the surface ends at the solid.
  const auto isNext = [&](std::array<int, 3> cell, int axis, int side) {
    cell[axis] += side;
    if (cell[axis] < 0 || cell[axis] >= l.n[axis]) {
      if (!l.periodic[axis]) return false;
      cell[axis] = (cell[axis] + l.n[axis]) % l.n[axis];
    }
    return fixed[l.index(cell[0], cell[1], cell[2])] == kNext;
  };
  std::vector<std::vector<std::ptrdiff_t>> films(l.n[2]);  // by plane
  forEachCell([&](std::ptrdiff_t c, const std::array<int, 3>& cell) {
    if (fixed[c] == kAway) return;
    bool ends = fixed[c] == kNext;
    for (int a = 0; a < 3 && !ends; ++a) ends = isNext(cell, a, -1) || isNext(cell, a, 1);
    if (!ends) {
      films[cell[2]].push_back(c);
      return;
    }
    Range& range = ranges.at(cell[1], cell[2]);
    range.least = std::min(range.least, next[c]);
  });
  for (const auto& plane : films) {
    for (const auto c : plane) {
      next[c] = kFar;
      fixed[c] = kAway;
    }
  }
  // A cell's neighbours are all of the other colour, so each colour at once, by any number of threads. Information
  // crosses a cell in each half-pass, and each adds 1/sqrt(3) at least to the distance.
  const int passes = static_cast<int>(std::ceil(kBand * std::sqrt(3.0))) + 1;
  for (int pass = 0; pass < passes; ++pass) {
    const double settled = (pass - 1) / std::sqrt(3.0);
    fillHalo(l, next);
    const RowRanges before = ranges;
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        // Rows that the surface has not reached yet, or in which all is settled.
        if (ranges.at(j, k).most <= settled || before.leastAround(j, k) >= kBand) continue;
        ranges.at(j, k) = relaxRow(l, l.index(0, j, k), (j + k + pass) & 1, fixed.data(), settled, next);
      }
    }
  }
#pragma omp parallel for simd schedule(static)
  for (std::size_t c = 0; c < l.size; ++c) next[c] = std::copysign(std::min(next[c], kBand), distance_[c]);
  distance_.swap(next);
  extendIntoHalo(l, distance_);
}

void FreeSurface::extendIntoSolids(const std::vector<float>& solid_distance, const FaceField<float>& at_faces) {
  if (full_ || empty_) return;
  const Lattice& l = grid_.lattice;
  copyField(distance_, scratch_.field);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        const double depth = solid_distance[c];
        if (depth > 0.0) continue;
        Eigen::Vector3d out;
        for (int a = 0; a < 3; ++a) {
          out[a] = static_cast<double>(solid_distance[c + l.stride[a]]) - solid_distance[c - l.stride[a]];
        }
        // In the middle of a wall the cells beyond it tell nothing.
        if (out.norm() < kClearSlope) {
          for (int a = 0; a < 3; ++a) out[a] = static_cast<double>(at_faces[a][c + l.stride[a]]) - at_faces[a][c];
        }
        const double length = out.norm();
        if (!(length > 0.0)) continue;
        const Eigen::Vector3d foot = Eigen::Vector3d(i, j, k) + out * ((kSampleBeyondSolid - depth) / length);
        const Eigen::Vector3d beyond = foot + out * (kSlopeBeyondFoot / length);
        Eigen::Vector3d slope;
        for (int a = 0; a < 3; ++a) {
          const Eigen::Vector3d half = 0.5 * Eigen::Vector3d::Unit(a);
          slope[a] = sampleLinear(l, distance_, beyond + half) - sampleLinear(l, distance_, beyond - half);
        }
        if (slope.norm() > 1.0) slope.normalize();
        scratch_.field[c] = sampleLinear(l, distance_, foot) + slope.dot(Eigen::Vector3d(i, j, k) - foot);
      }
    }
  }
  distance_.swap(scratch_.field);
  extendIntoHalo(l, distance_);
}

Eigen::Vector3d FreeSurface::normal(std::ptrdiff_t c) const {
  const Lattice& l = grid_.lattice;
  Eigen::Vector3d slope;
  for (int a = 0; a < 3; ++a) slope[a] = distance_[c + l.stride[a]] - distance_[c - l.stride[a]];
  const double length = slope.norm();
  return length > 0.0 ? Eigen::Vector3d(slope / length) : Eigen::Vector3d::UnitZ();
}

}  // namespace monolith
