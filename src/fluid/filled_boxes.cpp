#include "fluid/filled_boxes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "fluid/level_set.h"

namespace monolith {
namespace {

// Cells: a face that is so far within a solid or before it lies on it...
constexpr double kDeepestFace = 0.5, kFarthestFace = 0.01;
// ... if so far outwards the solid's surface is farther above by as much of that.
constexpr double kSlopeStep = 0.25;
constexpr double kAlongSolid = 0.7;
constexpr double kNudge = 1e-9;

}  // namespace

FilledBoxes::FilledBoxes(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
                         SolidDistance solid_distance)
    : grid_(grid), solid_distance_(std::move(solid_distance)) {
  for (const Eigen::AlignedBox3d& box : boxes) filled_.push_back({box, false});
  if (fill_height > 0.0) {
    const Eigen::Vector3d top_corner(grid.size()[0], grid.size()[1], fill_height);
    filled_.push_back({Eigen::AlignedBox3d(grid.origin, grid.origin + top_corner), true});
  }
  for (int a = 0; a < 3; ++a) {
    if (!grid.lattice.periodic[a]) continue;
    const Eigen::Vector3d period = grid.size()[a] * Eigen::Vector3d::Unit(a);
    for (std::size_t box = 0, own = filled_.size(); box < own; ++box) {
      for (const Eigen::Vector3d& shift : {Eigen::Vector3d(-period), period}) {
        filled_.push_back({filled_[box].box.translated(shift), filled_[box].by_level});
      }
    }
  }
}

bool FilledBoxes::isCovered(const Eigen::Vector3d& x) const {
  return std::any_of(filled_.begin(), filled_.end(), [&](const Filled& filled) { return filled.box.contains(x); });
}

// A solid that a face is cut by bounds nothing: the liquid ends at the face beside it.
bool FilledBoxes::isAlongSolid(const Eigen::Vector3d& x, const Eigen::Vector3d& outward) const {
  if (!solid_distance_) return false;
  const double distance = solid_distance_(x);
  if (!(distance > -kDeepestFace && distance < kFarthestFace)) return false;
  return distance - solid_distance_(x + kSlopeStep * grid_.h * outward) > kAlongSolid * kSlopeStep;
}

template <class Function>
void FilledBoxes::forEachFace(const Eigen::AlignedBox3d& box, Function&& f) const {
  for (int a = 0; a < 3; ++a) {
    for (const int side : {-1, 1}) {
      const double at = side < 0 ? box.min()[a] : box.max()[a];
      const double wall = grid_.origin[a] + (side < 0 ? 0.0 : grid_.size()[a]);
      // What is beyond a wall never counts.
      if (!grid_.lattice.periodic[a] && side * (wall - at) <= kNudge * grid_.h) continue;
      f(a, side, at);
    }
  }
}

// Faces in other liquid are no surface. Those on solids are none either, but for the level's: beside the body that it
// touches it goes on.
double FilledBoxes::insideBox(const Eigen::Vector3d& x, const Filled& filled) const {
  double inside = -kLevelSetFar;
  forEachFace(filled.box, [&](int a, int side, double at) {
    Eigen::Vector3d foot = x;
    foot[a] = at + side * kNudge * grid_.h;
    if (isCovered(foot) || (!filled.by_level && isAlongSolid(foot, side * Eigen::Vector3d::Unit(a)))) return;
    inside = std::max(inside, side * (x[a] - at) / grid_.h);
  });
  return inside;
}

double FilledBoxes::outsideBox(const Eigen::Vector3d& x, const Filled& filled) const {
  const Eigen::Vector3d nearest = x.cwiseMax(filled.box.min()).cwiseMin(filled.box.max());
  const bool behind_wall =
      !filled.by_level && isAlongSolid(nearest, (x - nearest).normalized()) && solid_distance_(x) > 0.0;
  if (behind_wall) return kLevelSetBand;
  Eigen::Vector3d outside = Eigen::Vector3d::Zero();
  forEachFace(filled.box, [&](int a, int side, double at) {
    outside[a] = std::max(outside[a], side * (x[a] - at) / grid_.h);
  });
  return outside.norm();
}

// Each of the faces is at most as near as the surface: the nearest counts, of the boxes around a point or, outside, of
// all.
double FilledBoxes::distance(const Eigen::Vector3d& x) const {
  double in = -kLevelSetFar, out = kLevelSetFar;
  for (const Filled& filled : filled_) {
    if (filled.box.contains(x)) {
      in = std::max(in, insideBox(x, filled));
    } else {
      out = std::min(out, outsideBox(x, filled));
    }
  }
  return in > -kLevelSetFar ? in : isCovered(x) ? -kLevelSetBand : out;
}

// The faces of the boxes divide the cell into blocks that lie in them or do not.
double FilledBoxes::part(const Eigen::Vector3d& centre) const {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * grid_.h);
  const Eigen::AlignedBox3d cell(centre - half, centre + half);
  std::vector<const Eigen::AlignedBox3d*> boxes;
  std::array<std::vector<double>, 3> cuts;
  for (int a = 0; a < 3; ++a) cuts[a] = {cell.min()[a], cell.max()[a]};
  for (const Filled& filled : filled_) {
    if (filled.box.contains(cell)) return 1.0;
    if (!filled.box.intersects(cell)) continue;
    boxes.push_back(&filled.box);
    for (int a = 0; a < 3; ++a) {
      for (const double at : {filled.box.min()[a], filled.box.max()[a]}) {
        if (at > cell.min()[a] && at < cell.max()[a]) cuts[a].push_back(at);
      }
    }
  }
  for (auto& along : cuts) std::sort(along.begin(), along.end());
  double volume = 0.0;
  for (std::size_t i = 1; i < cuts[0].size(); ++i) {
    for (std::size_t j = 1; j < cuts[1].size(); ++j) {
      for (std::size_t k = 1; k < cuts[2].size(); ++k) {
        const Eigen::AlignedBox3d block(Eigen::Vector3d(cuts[0][i - 1], cuts[1][j - 1], cuts[2][k - 1]),
                                        Eigen::Vector3d(cuts[0][i], cuts[1][j], cuts[2][k]));
        const bool covered = std::any_of(boxes.begin(), boxes.end(),
                                         [&](const Eigen::AlignedBox3d* box) { return box->contains(block.center()); });
        if (covered) volume += block.volume();
      }
    }
  }
  return volume / grid_.cellVolume();
}

}  // namespace monolith
