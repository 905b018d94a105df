#pragma once
// How thick a solid is: from a point of its surface straight in, to where the solid ends. Of a ball its diameter, of a
// cup that of its walls. Units m, the solid's frame.

#include <vector>

#include "geometry/signed_distance.h"

namespace monolith {

// At points of the surface that stand for about as much of it each, `spacing` squared; ascending, at most `most`.
std::vector<double> wallThickness(const SignedDistance& solid, double spacing, double most);

// Whether the solid ends within `thickness` behind the part of its surface that is nearest to a point.
bool isThinner(const SignedDistance& solid, const Eigen::Vector3d& point, double thickness);

}  // namespace monolith
