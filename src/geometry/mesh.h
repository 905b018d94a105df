#pragma once
// Triangle surfaces as solids: what makes one closed, and its volume.

#include "geometry/shape.h"

namespace monolith {

// Why a mesh does not bound a solid. All zero: it does.
struct MeshDefects {
  int open_edges = 0;          // edges that are not shared by exactly two triangles
  int misoriented_edges = 0;   // edges whose two triangles run along them in the same direction
  int inward_parts = 0;        // connected parts whose volume has the other sign than the whole (cavities)

  bool any() const { return open_edges + misoriented_edges + inward_parts > 0; }
};

// Merges vertices closer than `tolerance` (m) and drops the triangles that lose an edge by it, and vertices that
// no triangle uses.
TriangleMesh weldVertices(const TriangleMesh& mesh, double tolerance);

MeshDefects findDefects(const TriangleMesh& mesh);

// Divergence theorem; positive if the triangles are anticlockwise seen from outside.
double signedVolume(const TriangleMesh& mesh);

// Centre of the volume, m.
Eigen::Vector3d centroid(const TriangleMesh& mesh);

// Turns every triangle over.
void flipOrientation(TriangleMesh& mesh);

Eigen::AlignedBox3d vertexBounds(const TriangleMesh& mesh);

}  // namespace monolith
