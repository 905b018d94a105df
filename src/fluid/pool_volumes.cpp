// The volume of the liquid, of each pool by itself.

#include <algorithm>
#include <cmath>
#include <utility>

#include "fluid/free_surface.h"
#include "geometry/cube_fraction.h"
#include "solve/connected_runs.h"
#include "solve/disjoint_sets.h"
#include "solve/neighbours.h"

namespace monolith {
namespace {

constexpr double kLargestShift = 0.1;  // cells in one correction
constexpr int kCorrections = 8;
constexpr double kVolumeTolerance = 1e-10;
// A pool has so many whole cells so far below its surface.
constexpr int kLeastCellsOfPool = 27;
constexpr double kDeep = 0.5;  // cells

}  // namespace

double FreeSurface::partInLiquid(double distance, const Eigen::Vector3d& slope) {
  if (distance > 1.0) return 0.0;
  return distance > -1.0 ? insideFraction(distance, slope, 1.0) : 1.0;
}

// Drops and films are no pools: they count to the pool that is the nearest by the way around solids.
FreeSurface::Pools FreeSurface::findPools(const std::vector<double>& cell_fluid, const FaceField<double>& open) const {
  const Lattice& l = grid_.lattice;
  std::vector<std::uint8_t> has(l.size);
  const double *distance = distance_.data(), *fluid = cell_fluid.data();
  std::uint8_t* in_liquid = has.data();
#pragma omp parallel for simd schedule(static)
  for (std::size_t c = 0; c < l.size; ++c) in_liquid[c] = (distance[c] < 0.0) & (fluid[c] > 0.0);
  // Through all of them, whether there is liquid or not.
  const auto part = [&](int a) { return OpenParts<double>{open[a].data(), open[a].data()}; };
  ConnectedRuns runs(l, has, {part(0), part(1), part(2)});
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
    forEachNeighbour(l, c, [&](std::ptrdiff_t next, int a, int direction) {
      if (open[a][c + (direction > 0 ? l.stride[a] : 0)] > 0.0) reach(next, out.of[c]);
    });
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
        const int pool = pools.of.empty() ? 0 : pools.of[c];
        // What no pool is within reach of is not shifted, and in the first one's account.
        double& full = plane.full[std::max(pool, 0)];
        if (d <= -1.0 - margin) {
          full += cell_fluid[c];
          continue;
        }
        if (pool < 0) {
          full += partInLiquid(d, slopeAt(c)) * cell_fluid[c];
          continue;
        }
        plane.cells.push_back({d, cell_fluid[c], slopeAt(c), pool});
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
    const std::size_t count = plane.cells.size();
    CutCubes cubes;
    for (std::size_t first = 0; first < count; first += CutCubes::kCount) {
      const CutCell* cells = plane.cells.data() + first;
      const int at_once = static_cast<int>(std::min<std::size_t>(CutCubes::kCount, count - first));
      for (int i = 0; i < at_once; ++i) cubes.set(i, cells[i].distance + shifts[cells[i].pool], cells[i].slope);
      insideFractions(cubes, 1.0);
      for (int i = 0; i < at_once; ++i) {
        const double distance = cubes.distance[i];
        const double part = distance > 1.0 ? 0.0 : distance > -1.0 ? cubes.inside[i] : 1.0;
        plane.sum[cells[i].pool] += part * cells[i].fluid;
      }
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
  DisjointSets joined(now.count + pools_.count);  // pools of now, and behind them those of before
  int here = -1, there = -1;  // most cells are of the same two as the one before
  for (std::size_t c = 0; c < now.of.size(); ++c) {
    if (!(distance_[c] < 0.0) || now.of[c] < 0 || pools_.of[c] < 0) continue;
    if (now.of[c] == here && pools_.of[c] == there) continue;
    here = now.of[c];
    there = pools_.of[c];
    joined.unite(here, now.count + there);
  }
  known.clear();
  std::vector<int> number(joined.count(), -1);
  for (int pool = 0; pool < now.count; ++pool) {
    int& group = number[joined.root(pool)];
    if (group < 0) {
      group = static_cast<int>(known.size());
      known.push_back(-1.0);
    }
    group_of[pool] = group;
  }
  for (int pool = 0; pool < pools_.count; ++pool) {
    const int group = number[joined.root(now.count + pool)];
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

}  // namespace monolith
