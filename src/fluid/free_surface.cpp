#include "fluid/free_surface.h"

#include <algorithm>
#include <cmath>

#include "fluid/advection.h"
#include "fluid/interpolation.h"
#include "fluid/level_set.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kTravelToRedistance = 1.5;  // cells
constexpr double kClearSlope = 1.0;          // of the distance from a solid, over two cells: half of what it is
constexpr double kSampleBeyondSolid = 0.75;  // cells: outside, where the value is the liquid's own
constexpr double kSlopeBeyondFoot = 1.0;     // cells: further out, where the slope is

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
