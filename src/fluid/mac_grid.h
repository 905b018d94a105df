#pragma once
// The tank as a marker-and-cell grid (Harlow & Welch 1965): cubic cells of width h, face (i, j, k) of axis a at the low
// side of cell (i, j, k). World frame W; positions in m.

#include <Eigen/Dense>
#include <cmath>

#include "solve/lattice.h"

namespace monolith {

struct MacGrid {
  Lattice lattice;
  double h = 1.0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // corner with the least coordinates

  Eigen::Vector3d cellCenter(int i, int j, int k) const {
    return origin + h * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
  }
  Eigen::Vector3d faceCenter(int axis, int i, int j, int k) const {
    Eigen::Vector3d x = cellCenter(i, j, k);
    x[axis] -= 0.5 * h;
    return x;
  }
  // From x to that of its periodic images which is nearest to p.
  Eigen::Vector3d toNearestImage(const Eigen::Vector3d& x, const Eigen::Vector3d& p) const {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) {
      const double period = h * lattice.n[a];
      if (lattice.periodic[a]) shift[a] = -period * std::round((x[a] - p[a]) / period);
    }
    return shift;
  }
  Eigen::Vector3d size() const {
    return h * Eigen::Vector3d(lattice.n[0], lattice.n[1], lattice.n[2]);
  }
  double cellVolume() const { return h * h * h; }
};

}  // namespace monolith
