#pragma once
// Contact points of a triangle mesh with another solid: corners of each against the exact distance of the other,
// crossing edges, and a cylinder's rims and side lines. Meshes need not be convex.

#include "rigid/contact.h"
#include "rigid/convex_shape.h"
#include "rigid/mesh_surface.h"

namespace monolith {

constexpr int kMostPointsPerMeshPair = 16;

// A mesh placed in the world.
struct PlacedMesh {
  const MeshSurface* surface;
  Eigen::Isometry3d X_WG;

  DistanceSample sample(const Eigen::Vector3d& point) const;
};

// Append the contacts with gap <= margin, bodies unset, normals from b towards a (from the second argument
// towards the first). Points are half-way between the surfaces.
void appendMeshContacts(const PlacedMesh& a, const PlacedMesh& b, double margin, std::vector<Contact>& contacts);
void appendMeshContacts(const PlacedMesh& a, const ConvexShape& b, double margin,
                        std::vector<Contact>& contacts);

}  // namespace monolith
