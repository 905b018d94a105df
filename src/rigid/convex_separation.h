#pragma once
// Distance of two convex shapes by their separating direction. For a unit vector n from b towards a,
//     s(n) = min over x in a of n.x  -  max over y in b of n.y
// is a lower bound on their distance; the largest s is the distance when they are apart and minus the least
// translation that parts them when they overlap. s is evaluated exactly and is stationary at its largest
// value, so that a direction known to 1e-6 gives the distance to about 1e-12.

#include "rigid/convex_shape.h"

namespace monolith {

struct Separation {
  Eigen::Vector3d normal;  // unit, from b towards a
  double distance;         // m, negative: depth
};

double separationAlong(const ConvexShape& a, const ConvexShape& b, const Eigen::Vector3d& normal);

// Box against box is exact: corners, faces and edge pairs are all the candidates there are. Pairs with a sphere
// are exact by the distance field of the other. Pairs with a cylinder search for rims on top of the exact
// candidates; deep overlaps of cylinders may be reported deeper than the least translation, never shallower.
Separation findSeparation(const ConvexShape& a, const ConvexShape& b);

}  // namespace monolith
