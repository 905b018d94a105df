#include "geometry/mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace monolith {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

int findRoot(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void unite(std::vector<int>& parent, int i, int j) {
  i = findRoot(parent, i);
  j = findRoot(parent, j);
  // The least index represents a set, whatever the order of the calls.
  parent[std::max(i, j)] = std::min(i, j);
}

// Six times the signed volume of the tetrahedron between a triangle and an apex.
double sixVolume(const TriangleMesh& mesh, const Vector3i& triangle, const Vector3d& apex) {
  const Vector3d a = mesh.vertices[triangle[0]] - apex;
  const Vector3d b = mesh.vertices[triangle[1]] - apex;
  const Vector3d c = mesh.vertices[triangle[2]] - apex;
  return a.dot(b.cross(c));
}

int countInwardParts(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const Vector3i& triangle : mesh.triangles) {
    unite(parent, triangle[0], triangle[1]);
    unite(parent, triangle[0], triangle[2]);
  }
  const Vector3d apex = vertexBounds(mesh).center();
  std::map<int, double> part_volume;
  double total = 0.0;
  for (const Vector3i& triangle : mesh.triangles) {
    const double six_volume = sixVolume(mesh, triangle, apex);
    part_volume[findRoot(parent, triangle[0])] += six_volume;
    total += six_volume;
  }
  return static_cast<int>(std::count_if(part_volume.begin(), part_volume.end(),
                                        [&](const auto& part) { return part.second * total < 0.0; }));
}

}  // namespace

TriangleMesh weldVertices(const TriangleMesh& mesh, double tolerance) {
  const int count = static_cast<int>(mesh.vertices.size());
  // Sorted along a direction that no modelling tool favours: only near neighbours are near in this order, also
  // among the vertices of a face that is square to an axis.
  const Vector3d direction = Vector3d(0.5377, 0.6631, 0.5207).normalized();
  std::vector<double> position(count);
  for (int i = 0; i < count; ++i) position[i] = direction.dot(mesh.vertices[i]);
  std::vector<int> order(count), parent(count);
  std::iota(order.begin(), order.end(), 0);
  std::iota(parent.begin(), parent.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return position[i] < position[j]; });
  for (int i = 0; i < count; ++i) {
    const int vertex = order[i];
    for (int j = i + 1; j < count && position[order[j]] - position[vertex] <= tolerance; ++j) {
      if ((mesh.vertices[order[j]] - mesh.vertices[vertex]).norm() <= tolerance) unite(parent, vertex, order[j]);
    }
  }
  TriangleMesh welded;
  welded.source = mesh.source;
  std::vector<int> index(count, -1);
  for (const Vector3i& triangle : mesh.triangles) {
    Vector3i corners(findRoot(parent, triangle[0]), findRoot(parent, triangle[1]), findRoot(parent, triangle[2]));
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (int& corner : corners) {
      if (index[corner] < 0) {
        index[corner] = static_cast<int>(welded.vertices.size());
        welded.vertices.push_back(mesh.vertices[corner]);
      }
      corner = index[corner];
    }
    welded.triangles.push_back(corners);
  }
  return welded;
}

MeshDefects findDefects(const TriangleMesh& mesh) {
  struct EdgeUse {
    int forward = 0;   // from the lower to the higher index
    int backward = 0;
  };
  std::map<std::pair<int, int>, EdgeUse> edges;
  for (const Vector3i& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      EdgeUse& use = edges[std::minmax(from, to)];
      ++(from < to ? use.forward : use.backward);
    }
  }
  MeshDefects defects;
  for (const auto& [edge, use] : edges) {
    if (use.forward + use.backward != 2) {
      ++defects.open_edges;
    } else if (use.forward != 1) {
      ++defects.misoriented_edges;
    }
  }
  if (!defects.any()) defects.inward_parts = countInwardParts(mesh);
  return defects;
}

double signedVolume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0.0;
  // An apex amid the mesh keeps the round-off small for one that is far from its origin.
  const Vector3d apex = vertexBounds(mesh).center();
  double six_volume = 0.0;
  for (const Vector3i& triangle : mesh.triangles) six_volume += sixVolume(mesh, triangle, apex);
  return six_volume / 6.0;
}

Vector3d centroid(const TriangleMesh& mesh) {
  const Vector3d apex = vertexBounds(mesh).center();
  double sum = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (const Vector3i& triangle : mesh.triangles) {
    const double part = sixVolume(mesh, triangle, apex);
    sum += part;
    // Of the tetrahedron: the mean of its corners.
    for (int corner = 0; corner < 3; ++corner) moment += 0.25 * part * (mesh.vertices[triangle[corner]] - apex);
  }
  return apex + moment / sum;
}

void flipOrientation(TriangleMesh& mesh) {
  for (Vector3i& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

Eigen::AlignedBox3d vertexBounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

}  // namespace monolith
