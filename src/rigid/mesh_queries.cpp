// Queries of MeshSurface that look at several triangles at once.
#include <algorithm>
#include <cmath>

#include "rigid/facing.h"
#include "rigid/mesh_surface.h"

namespace monolith {

using Eigen::Vector3d;

std::vector<int> MeshSurface::trianglesWithin(const Vector3d& point, double radius) const {
  std::vector<int> triangles;
  std::vector<int> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (node.box.squaredExteriorDistance(point) > radius * radius) continue;
    if (node.left >= 0) {
      open.push_back(node.left);
      open.push_back(node.right);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      if ((nearestOn(order_[i], point).point - point).norm() <= radius) triangles.push_back(order_[i]);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

bool MeshSurface::sampleFacing(const Vector3d& point, const Vector3d& corner_normal, double slack,
                               DistanceSample& chosen) const {
  const DistanceSample nearest = sample(point);
  FacingChoice choice(nearest, corner_normal, slack);
  for (const int t : trianglesWithin(point, std::abs(nearest.distance) + slack)) {
    const Vector3d& normal = triangle_normals_[t];
    const double height = normal.dot(point - vertices_[triangles_[t][0]]);
    const double beside = (nearestOn(t, point).point - (point - height * normal)).norm();
    choice.offer(normal, height, beside);
  }
  return choice.take(chosen);
}

std::vector<Vector3d> MeshSurface::localNearestPoints(const Vector3d& centre, double radius) const {
  // Locally nearest: for every triangle that meets there it is the nearest point.
  const std::vector<int> triangles = trianglesWithin(centre, radius);
  std::vector<Vector3d> nearest;
  for (const int t : triangles) nearest.push_back(nearestOn(t, centre).point);
  const double same = 1e-9 * bounds().diagonal().norm();
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Vector3d& point = nearest[i];
    if (triangle_normals_[triangles[i]].dot(centre - point) <= 0.0) continue;
    bool local = true;
    for (std::size_t j = 0; j < triangles.size() && local; ++j) {
      local = (nearest[j] - point).norm() <= same || (nearestOn(triangles[j], point).point - point).norm() > same;
    }
    const bool known =
        std::any_of(points.begin(), points.end(), [&](const Vector3d& p) { return (p - point).norm() <= same; });
    if (local && !known) points.push_back(point);
  }
  return points;
}

}  // namespace monolith
