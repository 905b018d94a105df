#pragma once
// The volume that a body displaces, and its centre. Planes that cut the octants of cells (octant_fractions.h) make a
// convex body too large, a sphere 4 cells across by 0.4 %, and put its centre off: one that floats in mid-liquid would
// rise or sink and, with nothing to right it, begin to spin. So the fractions of the faces that a body cuts are
// changed, each by a part of itself and of the rest, until their volume is the body's and their centre the body's; what
// is left, 6e-5 of a sphere at most (`./tank validate hydrostatics`), are faces too narrow to stay open:
//   W <- W + W (1 - W) (a + b . x),    sum W h^3 = V,   sum W x h^3 = V x_c     for the faces of each axis.

#include "coupling/solid_fractions.h"
#include "geometry/shape.h"

namespace monolith {

// displaced: of the whole body, in the world frame. All of the body must lie in the box of the fractions.
void fitMoments(const MacGrid& grid, const Displacement& displaced, BodyFractions& fractions);

}  // namespace monolith
