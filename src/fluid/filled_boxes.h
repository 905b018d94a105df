#pragma once
// Where the liquid is at the start: below a level and in boxes, as a distance from its surface.

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "fluid/mac_grid.h"

namespace monolith {

// Of points in W, in cell widths, from the nearest solid; may be missing.
using SolidDistance = std::function<double(const Eigen::Vector3d&)>;

class FilledBoxes {
 public:
  // fill_height: m above the tank's floor.
  FilledBoxes(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
              SolidDistance solid_distance);

  // Of a point in W from the liquid's surface, in cell widths, negative in the liquid. Where faces of boxes lie on the
  // tank's walls, on solids or in other liquid there is no surface.
  double distance(const Eigen::Vector3d& x) const;

  // Part of a cell, by its centre (W), that lies in the boxes, solids or not.
  double part(const Eigen::Vector3d& centre) const;

 private:
  struct Filled {
    Eigen::AlignedBox3d box;
    bool by_level;
  };
  bool isCovered(const Eigen::Vector3d& x) const;
  bool isAlongSolid(const Eigen::Vector3d& x, const Eigen::Vector3d& outward) const;
  double insideBox(const Eigen::Vector3d& x, const Filled& filled) const;
  double outsideBox(const Eigen::Vector3d& x, const Filled& filled) const;
  // f(axis, side, at): for the faces of a box that do not lie on the tank's walls; at: their place along the axis.
  template <class Function>
  void forEachFace(const Eigen::AlignedBox3d& box, Function&& f) const;

  MacGrid grid_;
  SolidDistance solid_distance_;
  std::vector<Filled> filled_;  // with their periodic images next to the tank
};

}  // namespace monolith
