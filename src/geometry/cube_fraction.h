#pragma once
// Part of a cube that lies inside a solid, from the distance and gradient at its centre: the surface is taken as the
// plane through the nearest surface point (Scardovelli & Zaleski 2000, J. Comput. Phys. 164, 228). Error of second
// order in width times curvature.

#include <Eigen/Dense>

namespace monolith {

// 0: all outside, 1: all inside. `gradient` need not be of unit length; `distance` and `width` in m.
double insideFraction(double distance, const Eigen::Vector3d& gradient, double width);

}  // namespace monolith
