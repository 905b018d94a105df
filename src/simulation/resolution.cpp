#include "simulation/resolution.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "geometry/wall_thickness.h"

namespace monolith {
namespace {

constexpr double kLeastAcross = 3.0;  // cells: below, forces of the liquid are wrong by more than a few percent
constexpr double kLeastWall = 1.0;    // cells: below, nothing of a wall may be seen on the grid
constexpr double kLeastWide = 4.0;    // cells: a wall is so wide, that is more than it is thick
// Edges and tips are thinner than the rest: a wall is what so much of the surface belongs to.
constexpr double kPartOfSurface = 0.1;
constexpr double kMostSamples = 200.0;  // along a body's diagonal
constexpr double kTolerance = 0.01;      // of a length: facets of a mesh lie within what they stand for

}  // namespace

BodyResolution judgeResolution(double cell_width, const RigidBody& body) {
  const Eigen::Vector3d size = body.distance->bounds().sizes();
  const double spacing = std::max(cell_width, size.norm() / kMostSamples);
  const std::vector<double> thickness = wallThickness(*body.distance, spacing, kLeastAcross * cell_width);
  BodyResolution out;
  if (thickness.empty()) return out;
  // A ball or a rod of less than a cell has liquid on all sides anyway.
  std::array<double, 3> sides = {size[0], size[1], size[2]};
  std::sort(sides.begin(), sides.end());
  const bool divides = sides[1] >= kLeastWide * cell_width;
  if (divides) out.thinnest = thickness.front();
  const double wall = thickness[static_cast<std::size_t>(kPartOfSurface * static_cast<double>(thickness.size()))];
  const double across = sides[0];
  std::ostringstream text;
  const auto tell = [&](double length) {
    text << length << " m, " << length / cell_width << " cells of tank/cell_width";
  };
  if (divides && wall < kLeastWall * cell_width * (1.0 - kTolerance)) {
    text << "body '" << body.name << "': walls of ";
    tell(wall);
    text << ": liquid passes through them; expected at least " << kLeastWall << " cell, better 2";
  } else if (across < kLeastAcross * cell_width * (1.0 - kTolerance)) {
    text << "body '" << body.name << "': ";
    tell(across);
    text << " across: forces of the liquid on it are rough; expected at least " << kLeastAcross << " cells, better 4";
  }
  out.warning = text.str();
  return out;
}

}  // namespace monolith
