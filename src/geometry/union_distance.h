#pragma once
// Signed distance of a solid that is made of several, its parts, which may touch or overlap. Outside it is the least of
// the parts' distances, exactly. Inside that would be zero on a face which two parts have in common, so there the depth
// is that below the surface of the whole, and the gradient points to it.

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "geometry/signed_distance.h"

namespace monolith {

// A solid G placed in the body B. The bounds are given, because the box around a turned box is larger than the one
// around a turned sphere.
struct PlacedSolid {
  std::shared_ptr<const SignedDistance> field;
  Eigen::Isometry3d X_GB;
  Eigen::AlignedBox3d bounds_B;
};

// In the frame of the body. Near a face in common depths are right up to a few times `resolution` (m), and no less than
// that beyond; parts that are apart by no more than a small part of it touch.
std::shared_ptr<const SignedDistance> makeUnionDistance(std::vector<PlacedSolid> parts, double resolution);

}  // namespace monolith
