#pragma once
// Corners: points of a solid that touch another one first, with the direction that they point.

#include <vector>

#include "rigid/contact.h"
#include "rigid/convex_shape.h"

namespace monolith {

struct PlacedMesh;

struct Corner {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // unit, outward
};

// Corners of a box; of a cylinder the rim points and ends of side lines that point at the mesh near it.
std::vector<Corner> cornersFacing(const ConvexShape& shape, const PlacedMesh& mesh);

// MeshSurface::sampleFacing for a box or cylinder; all in W.
bool sampleFacing(const ConvexShape& shape, const Eigen::Vector3d& point, const Eigen::Vector3d& corner_normal,
                  double slack, DistanceSample& sample);

// Contact of a corner with a solid that it has this sample of; the normal away from that solid.
void appendCorner(const Corner& corner, const DistanceSample& sample, double margin,
                  std::vector<Contact>& contacts);

}  // namespace monolith
