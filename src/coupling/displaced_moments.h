#pragma once
// Buoyancy to the last digit. Planes that cut the octants of cells (octant_fractions.h) make a convex body too large,
// by 0.3 % for a sphere 4 cells across, and put its centre off by some thousandths of a cell. That would let a body
// that floats in mid-liquid rise or sink, and spin a sphere, at rest, to some rad/s. So the fractions of the faces that
// a body cuts are changed, each by at most a part of itself and of the rest, until their volume is the body's and its
// centre the body's:
//   W <- W + W (1 - W) (a + b . x),    sum W h^3 = V,   sum W x h^3 = V x_c     for the faces of each axis.

#include "coupling/solid_fractions.h"
#include "geometry/shape.h"

namespace monolith {

// displaced: of the whole body, in the world frame. All of the body must lie in the box of the fractions.
void fitMoments(const MacGrid& grid, const Displacement& displaced, BodyFractions& fractions);

}  // namespace monolith
