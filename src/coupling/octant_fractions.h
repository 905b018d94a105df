#pragma once
// Solid parts of the eight octants of a cube, each from eight planes (geometry/cube_fraction.h): exact for planes, of
// second order for curved surfaces. The control volumes of a staggered grid (cells, faces, edges) are all made of such
// octants, so their fractions agree with each other.

#include <Eigen/Dense>
#include <array>

#include "geometry/signed_distance.h"

namespace monolith {

// Octant o lies on the high side along axis a if bit a of o is set.
using Octants = std::array<double, 8>;

// `center` and the distance in the solid's frame, whose attitude is R_WB; the cube is aligned with W.
void octantFractions(const SignedDistance& solid, const Eigen::Vector3d& center, const Eigen::Matrix3d& R_WB,
                     double width, Octants& out);

}  // namespace monolith
