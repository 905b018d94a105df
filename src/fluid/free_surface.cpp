#include "fluid/free_surface.h"

#include <algorithm>
#include <cmath>

#include "fluid/advection.h"
#include "fluid/interpolation.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kTravelToRedistance = 1.5;  // cells
// Cells: a box of liquid whose face is so far within a solid or before it ends at the solid.
constexpr double kDeepestFace = 0.5, kFarthestFace = 0.01;
constexpr double kSlopeStep = 0.25;          // cells, outwards
constexpr double kAlongSolid = 0.7;          // of that, by which the solid's surface is then farther above
constexpr double kClearSlope = 1.0;          // of the distance from a solid, over two cells: half of what it is
constexpr double kSampleBeyondSolid = 0.75;  // cells: outside, where the value is the liquid's own
constexpr double kSlopeBeyondFoot = 1.0;     // cells: further out, where the slope is

}  // namespace

FreeSurface::FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
                         const std::function<double(const Eigen::Vector3d&)>& solid_distance)
    : grid_(grid) {
  const Lattice& l = grid.lattice;
  distance_.assign(l.size, kLevelSetFar);
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
  // A face, of which `outward` is the normal, that lies along a solid: one that is cut by it bounds the liquid beside
  // it.
  const auto onSolid = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& outward) {
    if (!solid_distance) return false;
    const double distance = solid_distance(x);
    if (!(distance > -kDeepestFace && distance < kFarthestFace)) return false;
    return distance - solid_distance(x + kSlopeStep * grid.h * outward) > kAlongSolid * kSlopeStep;
  };
  // A box's faces on the tank's walls do not bound the liquid, what is beyond them never counts; nor do its faces where
  // they meet other liquid or lie on a solid. The level's does where a body touches it: beside the body it goes on.
  const auto boxDistance = [&](const Eigen::Vector3d& x, const Filled& filled, bool within) {
    const Eigen::AlignedBox3d& box = filled.box;
    const double nudge = 1e-9 * grid.h;
    Eigen::Vector3d outside = Eigen::Vector3d::Zero();
    double inside = -kLevelSetFar;
    for (int a = 0; a < 3; ++a) {
      for (const int side : {-1, 1}) {
        const double at = side < 0 ? box.min()[a] : box.max()[a];
        const double wall = grid.origin[a] + (side < 0 ? 0.0 : grid.size()[a]);
        if (!l.periodic[a] && side * (wall - at) <= nudge) continue;
        Eigen::Vector3d foot = x;
        foot[a] = at + side * nudge;
        if (within && (isCovered(foot) || (!filled.by_level && onSolid(foot, side * Eigen::Vector3d::Unit(a)))))
          continue;
        const double d = side * (x[a] - at) / grid.h;
        outside[a] = std::max(outside[a], d);
        inside = std::max(inside, d);
      }
    }
    if (within) return inside;
    const Eigen::Vector3d nearest = x.cwiseMax(box.min()).cwiseMin(box.max());
    const bool behind_wall =
        !filled.by_level && onSolid(nearest, (x - nearest).normalized()) && solid_distance(x) > 0.0;
    return behind_wall ? kLevelSetBand : outside.norm();
  };
  // Each of the faces is at most as near as the surface: the nearest counts, of the boxes around a point or, outside, of
  // all.
  const auto unionDistance = [&](const Eigen::Vector3d& x) {
    double in = -kLevelSetFar, out = kLevelSetFar;
    for (const Filled& filled : all) {
      const bool within = filled.box.contains(x);
      const double d = boxDistance(x, filled, within);
      (within ? in : out) = within ? std::max(in, d) : std::min(out, d);
    }
    return in > -kLevelSetFar ? in : isCovered(x) ? -kLevelSetBand : out;
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
