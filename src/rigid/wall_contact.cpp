#include "rigid/wall_contact.h"

#include "rigid/contact_reduction.h"
#include "rigid/convex_manifold.h"
#include "rigid/convex_shape.h"
#include "rigid/mesh_manifold.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

// The points of a shape that can touch a plane which comes from `outward`.
std::vector<Vector3d> pointsTowards(const ConvexShape& shape, const Vector3d& outward) {
  if (shape.kind == Shape::Kind::kBox) return boxCorners(shape);
  if (shape.kind == Shape::Kind::kSphere) return {supportPoint(shape, outward)};
  std::vector<Vector3d> points = pieceTowards(shape, outward);
  // The other rim too: a cylinder about to tip over or to fall flat.
  const Vector3d support = supportPoint(shape, outward);
  const double height = shape.axis(2).dot(support - shape.centre());
  points.push_back(support);
  points.push_back(support - 2.0 * height * shape.axis(2));
  return points;
}

}  // namespace

void appendWallContacts(int body, const Shape& shape, const Eigen::Isometry3d& X_WG,
                        const std::vector<Vector3d>& vertices, const TankWalls& walls, double margin,
                        std::vector<Contact>& contacts) {
  const bool is_mesh = shape.kind == Shape::Kind::kMesh;
  Eigen::AlignedBox3d reach = bounds(shape, X_WG * shape.X_BG.inverse());
  for (int axis = 0; axis < 3; ++axis) {
    if (walls.periodic[axis]) continue;
    for (const double side : {-1.0, 1.0}) {
      const double plane = side < 0.0 ? walls.inside.min()[axis] : walls.inside.max()[axis];
      const double nearest = side < 0.0 ? reach.min()[axis] - plane : plane - reach.max()[axis];
      if (nearest > margin) continue;
      const Vector3d outward = side * Vector3d::Unit(axis);
      std::vector<Contact> found;
      const auto offer = [&](const Vector3d& point) {
        const double gap = side * (plane - point[axis]);
        if (gap <= margin) found.push_back({body, Contact::kWall, point, -outward, gap});
      };
      if (is_mesh) {
        for (const Vector3d& vertex : vertices) offer(X_WG * vertex);
      } else {
        for (const Vector3d& point : pointsTowards(placeConvex(shape, X_WG), outward)) offer(point);
      }
      mergeCoincident(found, 1e-5 * reach.diagonal().norm());
      reduceContacts(found, is_mesh ? kMostPointsPerMeshPair : kMostPointsPerConvexPair);
      contacts.insert(contacts.end(), found.begin(), found.end());
    }
  }
}

}  // namespace monolith
