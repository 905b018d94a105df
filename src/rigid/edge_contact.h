#pragma once
// Convex edges against edges and cylinders: what touches where no corner is near a face.

#include <vector>

#include "rigid/contact.h"
#include "rigid/convex_shape.h"
#include "rigid/mesh_surface.h"

namespace monolith {

std::vector<SurfaceEdge> boxEdges(const ConvexShape& box);

// Pairs that cross within both edges and face each other: the common perpendicular lies between the two sides'
// normals of either edge. Gaps from -deepest to margin; normals from b towards a; all in W.
void appendCrossingEdges(const std::vector<SurfaceEdge>& edges_a, const std::vector<SurfaceEdge>& edges_b,
                         double margin, double deepest, std::vector<Contact>& contacts);

// The point of each edge that is nearest to the cylinder (or deepest in it), if it is not an end.
void appendEdgesOnCylinder(const std::vector<SurfaceEdge>& edges, const ConvexShape& cylinder, double margin,
                           double deepest, std::vector<Contact>& contacts);

}  // namespace monolith
