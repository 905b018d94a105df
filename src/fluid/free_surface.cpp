#include "fluid/free_surface.h"

#include <algorithm>
#include <cmath>

#include "fluid/advection.h"
#include "fluid/interpolation.h"
#include "fluid/level_set.h"
#include "solve/marked_entries.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kTravelToRedistance = 1.5;  // cells
constexpr double kClearSlope = 1.0;          // of the distance from a solid, over two cells: half of what it is
constexpr double kSampleBeyondSolid = 0.75;  // cells: outside, where the value is the liquid's own
constexpr double kSlopeBeyondFoot = 1.0;     // cells: further out, where the slope is
// Cells that are fitted to what the boxes hold of them: so far from the surface at most, farther than that from solids,
// cells...
constexpr double kFarthestFitted = 2.0, kBesideSolid = 1.0;
constexpr double kMostOfCut = 0.5;  // cells: the distance of one that the surface cuts is looked for from there
// ... where the distance has so much slope over two cells: in the middle of a sheet no plane tells anything...
constexpr double kLeastFittedSlope = 0.5;
// ... to this part of a cell, or as closely as so many sweeps do; most take four.
constexpr double kFitTolerance = 0.005;
constexpr int kFitSweeps = 10;

}  // namespace

FreeSurface::FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
                         const SolidDistance& solid_distance)
    : grid_(grid) {
  const Lattice& l = grid.lattice;
  const FilledBoxes liquid(grid, fill_height, boxes, solid_distance);
  distance_.assign(l.size, kLevelSetFar);
  full_ = true;
  empty_ = true;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const double d = liquid.distance(grid.cellCenter(i, j, k));
        distance_[l.index(i, j, k)] = d;
        full_ = full_ && d <= -0.5;
        empty_ = empty_ && d >= 0.0;
      }
    }
  }
  // A tank filled to within half a cell of its lid still has a surface unless it is filled to the lid.
  if (fill_height > 0.0 && fill_height < grid.size()[2] * (1.0 - 1e-12) && boxes.empty()) full_ = false;
  extendIntoHalo(l, distance_);
  if (!boxes.empty() && !full_ && !empty_) fitToParts(liquid, solid_distance);
}

// A plane at the distance from an edge or a corner leaves more of a cell in the liquid, or less, than there is: of a
// cube of a few cells, half as much again. Where faces are far apart nothing changes.
void FreeSurface::fitToParts(const FilledBoxes& liquid, const SolidDistance& solid_distance) {
  const Lattice& l = grid_.lattice;
  struct Fitted {
    std::ptrdiff_t cell;
    double part;
    double distance;
  };
  std::vector<Fitted> fitted;
  std::vector<std::ptrdiff_t> wet;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        const Eigen::Vector3d centre = grid_.cellCenter(i, j, k);
        if (solid_distance && !(solid_distance(centre) > kBesideSolid)) continue;
        const double part = liquid.part(centre);
        // Beside a seam an edge may be near where no face is.
        const bool cut = part > kFitTolerance && part < 1.0 - kFitTolerance;
        if (cut) distance_[c] = std::clamp(distance_[c], -kMostOfCut, kMostOfCut);
        if (std::abs(distance_[c]) > kFarthestFitted) continue;
        fitted.push_back({c, part, distance_[c]});
        if (distance_[c] < 0.0) wet.push_back(c);
      }
    }
  }
  extendIntoHalo(l, distance_);
  const std::vector<double> before = distance_;
  for (int sweep = 0; sweep < kFitSweeps; ++sweep) {
    bool changed = false;
    for (Fitted& cell : fitted) {
      const Eigen::Vector3d slope = slopeAt(cell.cell);
      const double excess = partInLiquid(cell.distance, slope) - cell.part;
      if (std::abs(excess) <= kFitTolerance || slope.norm() < kLeastFittedSlope) continue;
      cell.distance += excess;
      changed = true;
    }
    if (!changed) break;
    for (const Fitted& cell : fitted) distance_[cell.cell] = cell.distance;
    extendIntoHalo(l, distance_);
  }
  // Liquid of a few cells that hold little each is in one of them still.
  for (const auto c : wet) {
    bool lost = true;
    for (const int k : {-1, 0, 1}) {
      for (const int j : {-1, 0, 1}) {
        for (const int i : {-1, 0, 1}) {
          lost = lost && distance_[c + i * l.stride[0] + j * l.stride[1] + k * l.stride[2]] >= 0.0;
        }
      }
    }
    if (lost) distance_[c] = before[c];
  }
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
  const int parts =
      static_cast<int>(std::ceil(std::clamp<double>(cells, 1.0, n[0] + n[1] + n[2]) / (kLevelSetBand - 1.0)));
  for (int part = 0; part < parts; ++part) {
    advectCells(grid_, velocity, distance_, dt / parts, kLevelSetBand, scratch_.field);
    distance_.swap(scratch_.field);
    extendIntoHalo(grid_.lattice, distance_);
    travelled_ += cells / parts;
    if (travelled_ > kTravelToRedistance) redistance(solid_distance);
  }
}

void FreeSurface::extendIntoSolids(const std::vector<float>& solid_distance, const FaceField<float>& at_faces) {
  if (full_ || empty_) return;
  const Lattice& l = grid_.lattice;
  // By plane; written when all have been read.
  struct Continued {
    std::ptrdiff_t cell;
    double distance;
  };
  std::vector<std::vector<Continued>> continued(l.n[2]);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    thread_local RowMarks marks;
    for (int j = 0; j < l.n[1]; ++j) {
      const auto row = l.index(0, j, k);
      std::uint8_t* in_solid = marks.start(l.n[0]);
      const float* distance = solid_distance.data() + row;
#pragma omp simd
      for (int i = 0; i < l.n[0]; ++i) in_solid[i] = distance[i] <= 0.0F;
      marks.forEach([&](std::ptrdiff_t i) {
        const auto c = row + i;
        const double depth = solid_distance[c];
        Eigen::Vector3d out;
        for (int a = 0; a < 3; ++a) {
          out[a] = static_cast<double>(solid_distance[c + l.stride[a]]) - solid_distance[c - l.stride[a]];
        }
        // In the middle of a wall the cells beyond it tell nothing.
        if (out.norm() < kClearSlope) {
          for (int a = 0; a < 3; ++a) out[a] = static_cast<double>(at_faces[a][c + l.stride[a]]) - at_faces[a][c];
        }
        const double length = out.norm();
        if (!(length > 0.0)) return;
        const Eigen::Vector3d foot =
            Eigen::Vector3d(static_cast<double>(i), j, k) + out * ((kSampleBeyondSolid - depth) / length);
        const Eigen::Vector3d beyond = foot + out * (kSlopeBeyondFoot / length);
        Eigen::Vector3d slope;
        for (int a = 0; a < 3; ++a) {
          const Eigen::Vector3d half = 0.5 * Eigen::Vector3d::Unit(a);
          slope[a] = sampleLinear(l, distance_, beyond + half) - sampleLinear(l, distance_, beyond - half);
        }
        if (slope.norm() > 1.0) slope.normalize();
        continued[k].push_back(
            {c, sampleLinear(l, distance_, foot) + slope.dot(Eigen::Vector3d(static_cast<double>(i), j, k) - foot)});
      });
    }
  }
  for (const auto& plane : continued) {
    for (const Continued& at : plane) distance_[at.cell] = at.distance;
  }
  extendIntoHalo(l, distance_);
}

Eigen::Vector3d FreeSurface::normal(std::ptrdiff_t c) const {
  const Eigen::Vector3d out = slopeAt(c);
  const double length = out.norm();
  return length > 0.0 ? Eigen::Vector3d(out / length) : Eigen::Vector3d::UnitZ();
}

}  // namespace monolith
