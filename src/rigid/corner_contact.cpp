#include "rigid/corner_contact.h"

#include <algorithm>
#include <cmath>

#include "rigid/facing.h"
#include "rigid/mesh_manifold.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

// Half-way between the outward normals of cap and side, as at every rim point.
Vector3d rimNormal(const ConvexShape& cylinder, const Vector3d& point) {
  const Vector3d axis = cylinder.axis(2);
  const Vector3d offset = point - cylinder.centre();
  const double height = axis.dot(offset);
  return ((offset - height * axis) / cylinder.radius + (height < 0.0 ? -axis : axis)) * std::sqrt(0.5);
}

std::vector<Corner> rimCorners(const ConvexShape& cylinder, const PlacedMesh& mesh) {
  // Two rounds: the mesh's direction from three places on the axis, then from the rim points that it gave.
  const Vector3d half_axis = cylinder.half_length * cylinder.axis(2);
  std::vector<Vector3d> seeds{cylinder.centre() - half_axis, cylinder.centre(), cylinder.centre() + half_axis};
  std::vector<Corner> corners;
  for (int round = 0; round < 2; ++round) {
    std::vector<Vector3d> points;
    for (const Vector3d& seed : seeds) {
      const Vector3d towards_mesh = -mesh.sample(seed).gradient;
      const Polygon piece = pieceTowards(cylinder, towards_mesh);
      if (round == 0) points.insert(points.end(), piece.begin(), piece.end());
      points.push_back(supportPoint(cylinder, towards_mesh));
    }
    for (const Vector3d& point : points) corners.push_back({point, rimNormal(cylinder, point)});
    seeds.assign(points.end() - 3, points.end());
  }
  return corners;
}

}  // namespace

std::vector<Corner> cornersFacing(const ConvexShape& shape, const PlacedMesh& mesh) {
  if (shape.kind == Shape::Kind::kCylinder) return rimCorners(shape, mesh);
  std::vector<Corner> corners;
  for (const Vector3d& point : boxCorners(shape)) {
    const Vector3d offset = shape.X_WG.linear().transpose() * (point - shape.centre());
    corners.push_back({point, shape.X_WG.linear() * offset.array().sign().matrix() * std::sqrt(1.0 / 3.0)});
  }
  return corners;
}

bool sampleFacing(const ConvexShape& shape, const Vector3d& point, const Vector3d& corner_normal, double slack,
                  DistanceSample& sample) {
  FacingChoice choice(sampleDistance(shape, point), corner_normal, slack);
  const Vector3d p = shape.X_WG.linear().transpose() * (point - shape.centre());
  if (shape.kind == Shape::Kind::kBox) {
    const Vector3d excess = p.cwiseAbs() - shape.half;
    for (int k = 0; k < 3; ++k) {
      Vector3d beside = excess.cwiseMax(0.0);
      beside[k] = 0.0;
      choice.offer((p[k] < 0.0 ? -1.0 : 1.0) * shape.axis(k), excess[k], beside.norm());
    }
  } else {
    const double from_axis = p.head<2>().norm();
    const double beyond_side = from_axis - shape.radius, beyond_cap = std::abs(p.z()) - shape.half_length;
    choice.offer((p.z() < 0.0 ? -1.0 : 1.0) * shape.axis(2), beyond_cap, std::max(beyond_side, 0.0));
    if (from_axis > 0.0) {
      const Vector3d radial = (p.x() * shape.axis(0) + p.y() * shape.axis(1)) / from_axis;
      choice.offer(radial, beyond_side, std::max(beyond_cap, 0.0));
    }
  }
  return choice.take(sample);
}

void appendCorner(const Corner& corner, const DistanceSample& sample, double margin, std::vector<Contact>& contacts) {
  if (sample.distance > margin) return;
  const Vector3d point = corner.point - 0.5 * sample.distance * sample.gradient;
  contacts.push_back({0, 0, point, sample.gradient, sample.distance, 1.0});
}

}  // namespace monolith
