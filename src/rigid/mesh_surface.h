#pragma once
// A closed triangle mesh as contact detection needs it: exact signed distance (the baked field of
// geometry/mesh_distance.h rounds edges off), and the edges and corners that can touch something. Frame of the
// shape, m. The sign is that of the angle-weighted pseudonormal (Baerentzen & Aanaes 2005).

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "geometry/shape.h"

namespace monolith {

// A convex edge between two triangles, or of a box. Outward unit normals on its two sides.
struct SurfaceEdge {
  Eigen::Vector3d start, end;
  Eigen::Vector3d normal_0, normal_1;
};

class MeshSurface : public SignedDistance {
 public:
  // Vertices at the same place are one. The mesh must be closed and oriented outwards.
  explicit MeshSurface(const TriangleMesh& mesh);

  DistanceSample sample(const Eigen::Vector3d& point) const override;
  Eigen::AlignedBox3d bounds() const override { return nodes_.front().box; }

  // Distance for a corner of another solid whose outward normal is `corner_normal`: by the face that faces it most
  // among those that are the nearest to within `slack` (m), so that corners flush with an edge rest on the
  // face. False if the nearest surface faces away: then another corner or edge is what touches.
  bool sampleFacing(const Eigen::Vector3d& point, const Eigen::Vector3d& corner_normal, double slack,
                    DistanceSample& sample) const;

  // Every vertex once, with the outward pseudonormal at each.
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  const std::vector<Eigen::Vector3d>& vertexNormals() const { return vertex_normals_; }
  const std::vector<Eigen::Vector3i>& triangles() const { return triangles_; }
  // Without flat and concave ones: those touch nothing that corners do not touch first.
  const std::vector<SurfaceEdge>& convexEdges() const { return convex_edges_; }

  // Points of the surface that are locally nearest to `centre` and within `radius` of it: several in a groove.
  // `centre` must be outside.
  std::vector<Eigen::Vector3d> localNearestPoints(const Eigen::Vector3d& centre, double radius) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0, count = 0;     // leaf: triangles in order_
    int left = -1, right = -1;    // inner node
  };
  struct Nearest {
    Eigen::Vector3d point;
    Eigen::Vector3d pseudonormal;  // not unit
  };

  void findNormalsAndEdges();
  int buildNode(int first, int count);
  Nearest nearestOn(int triangle, const Eigen::Vector3d& point) const;
  // In ascending order.
  std::vector<int> trianglesWithin(const Eigen::Vector3d& point, double radius) const;

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<Eigen::Vector3d> vertex_normals_;
  std::vector<Eigen::Vector3d> triangle_normals_;
  std::vector<std::array<Eigen::Vector3d, 3>> edge_normals_;  // of a triangle's edge k: corner k to k + 1
  std::vector<SurfaceEdge> convex_edges_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace monolith
