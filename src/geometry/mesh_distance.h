#pragma once
// Signed distance of a closed mesh, baked into a regular grid once and interpolated trilinearly from then on.
//
// Near the surface the value is the distance up to the error of interpolation, of the order of
// spacing^2 * curvature on smooth parts and a fraction of the spacing at edges. Where the baked band ends (four
// resolutions outside the bounding box) it becomes a lower bound on the distance that still grows outwards.
// The inside is baked whole. The gradient is that of the interpolant, made unit.

#include <memory>

#include "geometry/shape.h"

namespace monolith {

// `resolution` (m) is the largest spacing used; a mesh that is only a few of it across is baked finer. Throws
// std::invalid_argument unless it is positive and finite. The mesh must be free of defects (geometry/mesh.h).
std::shared_ptr<const SignedDistance> makeMeshDistance(const TriangleMesh& mesh, double resolution);

}  // namespace monolith
