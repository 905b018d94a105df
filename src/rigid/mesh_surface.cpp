#include "rigid/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "rigid/triangle.h"

namespace monolith {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

constexpr int kTrianglesPerLeaf = 4;
constexpr double kFlatCosine = 1.0 - 1e-6;  // two triangles in one plane to 1.4 mrad have no edge between them

struct LessByCoordinates {
  bool operator()(const Vector3d& a, const Vector3d& b) const {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  }
};

}  // namespace

MeshSurface::MeshSurface(const TriangleMesh& mesh) {
  std::map<Vector3d, int, LessByCoordinates> index_of;
  std::vector<int> index(mesh.vertices.size(), -1);
  for (const Vector3i& triangle : mesh.triangles) {
    Vector3i corners;
    for (int k = 0; k < 3; ++k) {
      const Vector3d& vertex = mesh.vertices[triangle[k]];
      const auto [entry, is_new] = index_of.emplace(vertex, static_cast<int>(vertices_.size()));
      if (is_new) vertices_.push_back(vertex);
      corners[k] = entry->second;
    }
    const Vector3d& a = vertices_[corners[0]];
    const double area = (vertices_[corners[1]] - a).cross(vertices_[corners[2]] - a).norm();
    if (area > 0.0) triangles_.push_back(corners);
  }
  findNormalsAndEdges();
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0);
  buildNode(0, static_cast<int>(order_.size()));
}

void MeshSurface::findNormalsAndEdges() {
  vertex_normals_.assign(vertices_.size(), Vector3d::Zero());
  edge_normals_.resize(triangles_.size());
  std::map<std::pair<int, int>, std::pair<int, int>> first_side;  // (low, high vertex) -> (triangle, edge)
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Vector3i& corners = triangles_[t];
    const auto corner = [&](int k) -> const Vector3d& { return vertices_[corners[k % 3]]; };
    const Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    triangle_normals_.push_back(normal);
    for (int k = 0; k < 3; ++k) {
      const Vector3d u = corner(k + 1) - corner(k), v = corner(k + 2) - corner(k);
      vertex_normals_[corners[k]] += std::atan2(u.cross(v).norm(), u.dot(v)) * normal;
      edge_normals_[t][k] = normal;
      const std::pair<int, int> key = std::minmax(corners[k], corners[(k + 1) % 3]);
      const auto [entry, is_new] = first_side.emplace(key, std::make_pair(static_cast<int>(t), k));
      if (is_new) continue;
      const auto [other, other_edge] = entry->second;
      const Vector3d& other_normal = triangle_normals_[other];
      edge_normals_[t][k] = edge_normals_[other][other_edge] = normal + other_normal;
      const Vector3d& opposite = vertices_[triangles_[other][(other_edge + 2) % 3]];
      const bool convex = normal.dot(opposite - corner(k)) < 0.0;
      if (convex && normal.dot(other_normal) < kFlatCosine) {
        convex_edges_.push_back({corner(k), corner(k + 1), normal, other_normal});
      }
    }
  }
  for (Vector3d& normal : vertex_normals_) normal.normalize();
}

int MeshSurface::buildNode(int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.first = first;
  node.count = count;
  const auto centre = [this](int t) -> Vector3d {
    return (vertices_[triangles_[t][0]] + vertices_[triangles_[t][1]] + vertices_[triangles_[t][2]]) / 3.0;
  };
  Eigen::AlignedBox3d centres;
  for (int i = first; i < first + count; ++i) {
    for (int k = 0; k < 3; ++k) node.box.extend(vertices_[triangles_[order_[i]][k]]);
    centres.extend(centre(order_[i]));
  }
  if (count > kTrianglesPerLeaf) {
    int axis = 0;
    centres.sizes().maxCoeff(&axis);
    const int half = count / 2;
    std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                     [&](int s, int t) {
                       const double x = centre(s)[axis], y = centre(t)[axis];
                       return x < y || (x == y && s < t);
                     });
    node.left = buildNode(first, half);
    node.right = buildNode(first + half, count - half);
  }
  nodes_[index] = node;
  return index;
}

MeshSurface::Nearest MeshSurface::nearestOn(int triangle, const Vector3d& point) const {
  const Vector3i& corners = triangles_[triangle];
  const TrianglePoint nearest =
      nearestOnTriangle(vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]], point);
  if (nearest.corner >= 0) return {nearest.point, vertex_normals_[corners[nearest.corner]]};
  if (nearest.edge >= 0) return {nearest.point, edge_normals_[triangle][nearest.edge]};
  return {nearest.point, triangle_normals_[triangle]};
}

DistanceSample MeshSurface::sample(const Vector3d& point) const {
  double least = std::numeric_limits<double>::max();
  Nearest nearest{Vector3d::Zero(), Vector3d::UnitZ()};
  std::vector<int> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (node.box.squaredExteriorDistance(point) > least) continue;
    if (node.left < 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const Nearest candidate = nearestOn(order_[i], point);
        const double squared = (candidate.point - point).squaredNorm();
        if (squared < least) least = squared, nearest = candidate;
      }
      continue;
    }
    const bool left_first =
        nodes_[node.left].box.squaredExteriorDistance(point) < nodes_[node.right].box.squaredExteriorDistance(point);
    open.push_back(left_first ? node.right : node.left);
    open.push_back(left_first ? node.left : node.right);
  }
  const Vector3d offset = point - nearest.point;
  const double distance = std::sqrt(least);
  const double side = offset.dot(nearest.pseudonormal) < 0.0 ? -1.0 : 1.0;
  // On the surface the offset is round-off and has no direction.
  if (distance < 1e-9 * nodes_.front().box.diagonal().norm()) {
    return {side * distance, nearest.pseudonormal.normalized()};
  }
  return {side * distance, side / distance * offset};
}

}  // namespace monolith
