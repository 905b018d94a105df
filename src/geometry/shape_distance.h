#pragma once
// Exact signed distances of the primitive shapes, in the shape's own frame: centred at the origin, a cylinder
// along z. Where the nearest surface point is not unique (the centre of a sphere, the medial surface of a
// box) the gradient is that of one of the nearest points, the same one each time. All 1-Lipschitz.

#include <Eigen/Geometry>
#include <memory>

#include "geometry/signed_distance.h"

namespace monolith {

std::shared_ptr<const SignedDistance> makeBoxDistance(const Eigen::Vector3d& size);
std::shared_ptr<const SignedDistance> makeSphereDistance(double radius);
std::shared_ptr<const SignedDistance> makeCylinderDistance(double radius, double length);

}  // namespace monolith
