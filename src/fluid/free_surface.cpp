#include "fluid/free_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fluid/advection.h"
#include "fluid/interpolation.h"
#include "geometry/cube_fraction.h"
#include "solve/connected_runs.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kFar = 1e3;               // cell widths
constexpr double kTravelToRedistance = 1.0;  // cells
constexpr double kLargestShift = 0.1;      // cells in one correction
constexpr int kCorrections = 8;
constexpr double kVolumeTolerance = 1e-10;
// A pool has so many whole cells so far below its surface.
constexpr int kLeastCellsOfPool = 27;
constexpr double kDeep = 0.5;  // cells
// Half-width, in cells, of the band around the surface in which the level set is a distance; beyond it is just as large
// as that, which is further than anyone looks.
constexpr double kBand = 6.0;
constexpr double kLongestWay = kBand - 1.0;  // cells in one advection, kTravelToRedistance being undone before the next
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

}  // namespace

FreeSurface::FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes)
    : grid_(grid) {
  const Lattice& l = grid.lattice;
  distance_.assign(l.size, kFar);
  const double top = grid.size()[2];
  const bool by_level = fill_height > 0.0;
  std::vector<Eigen::AlignedBox3d> all = boxes;
  if (by_level) {
    all.emplace_back(grid.origin, grid.origin + Eigen::Vector3d(grid.size()[0], grid.size()[1], fill_height));
  }
  // With the periodic images next to the tank.
  for (int a = 0; a < 3; ++a) {
    if (!l.periodic[a]) continue;
    const Eigen::Vector3d period = grid.size()[a] * Eigen::Vector3d::Unit(a);
    for (std::size_t box = 0, own = all.size(); box < own; ++box) {
      all.push_back(all[box].translated(-period));
      all.push_back(all[box].translated(period));
    }
  }
  const auto isCovered = [&](const Eigen::Vector3d& x) {
    return std::any_of(all.begin(), all.end(), [&](const auto& box) { return box.contains(x); });
  };
  // A box's faces on the tank's walls do not bound the liquid, what is beyond them never counts; nor do its faces where they
  // meet other liquid.
  const auto boxDistance = [&](const Eigen::Vector3d& x, const Eigen::AlignedBox3d& box, bool within) {
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
        if (within && isCovered(foot)) continue;
        const double d = side * (x[a] - at) / grid.h;
        outside[a] = std::max(outside[a], d);
        inside = std::max(inside, d);
      }
    }
    return within ? inside : outside.norm();
  };
  // Each of the faces is at most as near as the surface: the nearest counts, of the boxes around a point or, outside, of
  // all.
  const auto unionDistance = [&](const Eigen::Vector3d& x) {
    double in = -kFar, out = kFar;
    for (const auto& box : all) {
      const bool within = box.contains(x);
      (within ? in : out) = within ? std::max(in, boxDistance(x, box, true)) : std::min(out, boxDistance(x, box, false));
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

void FreeSurface::advect(const FaceField<double>& velocity, double dt, double maximum_speed) {
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
    if (travelled_ > kTravelToRedistance) redistance();
  }
}

void FreeSurface::redistance() {
  travelled_ = 0.0;
  const Lattice& l = grid_.lattice;
  std::vector<double>& next = scratch_.field;
  assignField(l.size, kFar, next);
  std::vector<std::uint8_t>& fixed = scratch_.fixed;
  assignZero(l.size, fixed);
  RowRanges ranges(l);
  // Next to the surface: the distance to the plane that the level set is there.
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        const double d = distance_[c];
        bool near = false;
        double slope2 = 0.0;
        for (int a = 0; a < 3; ++a) {
          const double low = distance_[c - l.stride[a]];
          const double high = distance_[c + l.stride[a]];
          const bool cut_low = (d < 0.0) != (low < 0.0);
          const bool cut_high = (d < 0.0) != (high < 0.0);
          near = near || cut_low || cut_high;
          // Across the surface where it is; central elsewhere.
          double slope = 0.5 * (high - low);
          if (cut_low && !cut_high) slope = d - low;
          if (cut_high && !cut_low) slope = high - d;
          // A bubble or drop of one cell: its two sides cancel in the central difference.
          if (cut_low && cut_high) slope = std::max(std::abs(d - low), std::abs(high - d));
          slope2 += slope * slope;
        }
        if (!near) continue;
        next[c] = std::abs(d) / std::max(std::sqrt(slope2), 0.1);
        fixed[c] = 1;
        ranges.at(j, k).least = std::min(ranges.at(j, k).least, next[c]);
      }
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

void FreeSurface::extendIntoSolids(const std::vector<float>& solid_distance) {
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

// Drops and films are no pools: they count to the pool that is the nearest by the way around solids.
FreeSurface::Pools FreeSurface::findPools(const std::vector<double>& cell_fluid, const FaceField<double>& open) const {
  const Lattice& l = grid_.lattice;
  std::vector<std::uint8_t> has(l.size);
#pragma omp parallel for simd schedule(static)
  for (std::size_t c = 0; c < l.size; ++c) has[c] = (distance_[c] < 0.0) & (cell_fluid[c] > 0.0);
  ConnectedRuns runs(l, has, open);
  std::vector<int> region_of;
  const int regions = runs.numberRegions(region_of);
  Pools out;
  if (regions <= 1) return out;
  std::vector<int> deep(regions, 0), pool_of(regions, -1);
  runs.forEachRun([&](int run, std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto c = begin; c < end; ++c) deep[region_of[run]] += distance_[c] < -kDeep && cell_fluid[c] == 1.0;
  });
  int pools = 0;
  for (int region = 0; region < regions; ++region) {
    if (deep[region] >= kLeastCellsOfPool) pool_of[region] = pools++;
  }
  if (pools <= 1) return out;
  out.count = pools;
  out.of.assign(l.size, -1);
  std::vector<std::ptrdiff_t> reached;
  const auto reach = [&](std::ptrdiff_t cell, int pool) {
    if (out.of[cell] >= 0) return;
    out.of[cell] = pool;
    reached.push_back(cell);
  };
  runs.forEachRun([&](int run, std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (pool_of[region_of[run]] < 0) return;
    for (auto c = begin; c < end; ++c) reach(c, pool_of[region_of[run]]);
  });
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto c = reached[i];
    const std::array<int, 3> at = l.cell(c);
    for (int a = 0; a < 3; ++a) {
      for (const int side : {0, 1}) {
        const bool ends = at[a] == (side == 0 ? 0 : l.n[a] - 1);
        if ((ends && !l.periodic[a]) || !(open[a][c + side * l.stride[a]] > 0.0)) continue;
        reach(c + (side == 0 ? -1 : 1) * (ends ? 1 - l.n[a] : 1) * l.stride[a], out.of[c]);
      }
    }
  }
  return out;
}

// The cells that the surface cuts when shifted by up to `margin`, plane by plane, and what the others hold.
FreeSurface::CutCells FreeSurface::findCutCells(double margin, const std::vector<double>& cell_fluid,
                                                const Pools& pools) const {
  const Lattice& l = grid_.lattice;
  CutCells out(l.n[2]);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    CutPlane& plane = out[k];
    plane.full.assign(pools.count, 0.0);
    for (int j = 0; j < l.n[1]; ++j) {
      const auto row = l.index(0, j, k);
      for (auto c = row; c < row + l.n[0]; ++c) {
        const double d = distance_[c];
        if (d > 1.0 + margin || cell_fluid[c] == 0.0) continue;
        const int pool = pools.of.empty() ? 0 : std::max(pools.of[c], 0);
        if (d <= -1.0 - margin) {
          plane.full[pool] += cell_fluid[c];
          continue;
        }
        Eigen::Vector3d slope;
        for (int a = 0; a < 3; ++a) slope[a] = distance_[c + l.stride[a]] - distance_[c - l.stride[a]];
        plane.cells.push_back({d, cell_fluid[c], slope, pool});
      }
    }
  }
  return out;
}

// One sum per plane, added in order: the same bits at any thread count.
Eigen::VectorXd FreeSurface::shiftedVolumes(const Eigen::VectorXd& shifts, CutCells& cut) const {
  const int planes = static_cast<int>(cut.size());
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < planes; ++k) {
    CutPlane& plane = cut[k];
    plane.sum = plane.full;
    for (const CutCell& cell : plane.cells) {
      const double d = cell.distance + shifts[cell.pool];
      if (d > 1.0) continue;
      plane.sum[cell.pool] += (d > -1.0 ? insideFraction(d, cell.slope, 1.0) : 1.0) * cell.fluid;
    }
  }
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(shifts.size());
  for (const CutPlane& plane : cut) sum += Eigen::Map<const Eigen::VectorXd>(plane.sum.data(), sum.size());
  return sum * grid_.cellVolume();
}

double FreeSurface::volume(const std::vector<double>& cell_fluid) const {
  if (empty_) return 0.0;
  CutCells cut = findCutCells(0.0, cell_fluid, Pools());
  return shiftedVolumes(Eigen::VectorXd::Zero(1), cut).sum();
}

// Pools of now that have to do with the same ones of before share their volumes. Returns the group of each pool; known:
// of each group, what its pools of before ought to have held, m^3, or -1 if it has none.
std::vector<int> FreeSurface::groupPools(const Pools& now, std::vector<double>& known) const {
  std::vector<int> group_of(now.count, 0);
  known.assign(1, 0.0);
  if (now.of.empty() || pools_.of.empty()) return group_of;
  std::vector<int> parent(now.count + pools_.count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  int here = -1, there = -1;  // most cells are of the same two as the one before
  for (std::size_t c = 0; c < now.of.size(); ++c) {
    if (!(distance_[c] < 0.0) || now.of[c] < 0 || pools_.of[c] < 0) continue;
    if (now.of[c] == here && pools_.of[c] == there) continue;
    here = now.of[c];
    there = pools_.of[c];
    const int a = root(here), b = root(now.count + there);
    parent[std::max(a, b)] = std::min(a, b);
  }
  known.clear();
  std::vector<int> number(parent.size(), -1);
  for (int pool = 0; pool < now.count; ++pool) {
    int& group = number[root(pool)];
    if (group < 0) {
      group = static_cast<int>(known.size());
      known.push_back(-1.0);
    }
    group_of[pool] = group;
  }
  for (int pool = 0; pool < pools_.count; ++pool) {
    const int group = number[root(now.count + pool)];
    if (group >= 0) known[group] = std::max(known[group], 0.0) + pools_.volume[pool];
  }
  return group_of;
}

double FreeSurface::correctVolume(double target, const std::vector<double>& cell_fluid, const FaceField<double>& open) {
  if (full_ || empty_) return 0.0;
  constexpr double kStep = 1e-3;
  Pools now = findPools(cell_fluid, open);
  std::vector<double> known;
  const std::vector<int> group_of = groupPools(now, known);
  const auto groups = static_cast<Eigen::Index>(known.size());
  CutCells cut = findCutCells(kLargestShift + kStep, cell_fluid, now);
  Eigen::VectorXd by_pool;
  const auto volumes = [&](const Eigen::VectorXd& shifts) {
    by_pool = shiftedVolumes(shifts(group_of), cut);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(groups);
    for (int pool = 0; pool < now.count; ++pool) sum[group_of[pool]] += by_pool[pool];
    return sum;
  };
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(groups), v = volumes(shift), slope;
  const double before = v.sum();
  const auto findSlope = [&] {
    const Eigen::VectorXd step = Eigen::VectorXd::Constant(groups, kStep);
    slope = (volumes(shift + step) - volumes(shift - step)) / (2.0 * kStep);
  };
  Eigen::VectorXd wanted = Eigen::VectorXd::Constant(groups, target);
  if (groups > 1) {
    // What is new is as large as it is; what is missing of the whole all share.
    findSlope();
    double missing = target, surface = 0.0;
    for (Eigen::Index g = 0; g < groups; ++g) {
      wanted[g] = known[g] < 0.0 ? v[g] : known[g];
      missing -= wanted[g];
      if (known[g] >= 0.0) surface += slope[g];
    }
    for (Eigen::Index g = 0; g < groups && surface < 0.0; ++g) {
      if (known[g] >= 0.0) wanted[g] += missing * slope[g] / surface;
    }
  }
  for (int it = 0; it < kCorrections; ++it) {
    Eigen::VectorXd next = shift;
    for (Eigen::Index g = 0; g < groups; ++g) {
      if (std::abs(v[g] - wanted[g]) <= kVolumeTolerance * target) continue;
      if (slope.size() == 0) findSlope();
      if (!(slope[g] < 0.0)) continue;
      next[g] = std::clamp(shift[g] - (v[g] - wanted[g]) / slope[g], -kLargestShift, kLargestShift);
    }
    if (next == shift) break;
    const Eigen::VectorXd volume = volumes(next);
    // From the second on, the secant.
    for (Eigen::Index g = 0; g < groups; ++g) {
      if (next[g] != shift[g]) slope[g] = (volume[g] - v[g]) / (next[g] - shift[g]);
    }
    shift = next;
    v = volume;
  }
  if (now.count > 1) {
    // What could not be reached is still owed.
    v = volumes(shift);
    for (int pool = 0; pool < now.count; ++pool) {
      const int g = group_of[pool];
      now.volume.push_back(v[g] > 0.0 ? by_pool[pool] * wanted[g] / v[g] : 0.0);
    }
  }
  pools_ = std::move(now);
  if (shift.isZero(0.0)) return 0.0;
  const bool all = pools_.of.empty();
#pragma omp parallel for simd schedule(static)
  for (std::size_t c = 0; c < distance_.size(); ++c) {
    const int pool = all ? 0 : pools_.of[c];
    if (pool >= 0) distance_[c] += shift[group_of[pool]];
  }
  if (!all) extendIntoHalo(grid_.lattice, distance_);
  return v.sum() - before;
}

Eigen::Vector3d FreeSurface::normal(std::ptrdiff_t c) const {
  const Lattice& l = grid_.lattice;
  Eigen::Vector3d slope;
  for (int a = 0; a < 3; ++a) slope[a] = distance_[c + l.stride[a]] - distance_[c - l.stride[a]];
  const double length = slope.norm();
  return length > 0.0 ? Eigen::Vector3d(slope / length) : Eigen::Vector3d::UnitZ();
}

}  // namespace monolith
