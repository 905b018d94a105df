#pragma once
// The convex primitives (box, sphere, cylinder) placed in the world: what contact detection asks of them.
// All points and directions in W; directions are unit vectors; lengths m.

#include <Eigen/Geometry>
#include <vector>

#include "geometry/shape.h"

namespace monolith {

struct ConvexShape {
  Shape::Kind kind = Shape::Kind::kBox;
  Eigen::Isometry3d X_WG = Eigen::Isometry3d::Identity();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // kBox: half the edges
  double radius = 0.0;                             // kSphere, kCylinder
  double half_length = 0.0;                        // kCylinder

  Eigen::Vector3d centre() const { return X_WG.translation(); }
  Eigen::Vector3d axis(int i) const { return X_WG.linear().col(i); }  // a cylinder's own axis is axis(2)
};

// Corners of a flat piece of surface, anticlockwise seen from outside; two points are a line, one is a corner.
using Polygon = std::vector<Eigen::Vector3d>;

struct Face {
  Polygon polygon;
  Eigen::Vector3d normal;  // outward
};

// `shape` must not be a mesh.
ConvexShape placeConvex(const Shape& shape, const Eigen::Isometry3d& X_WG);

// The point farthest along `direction`.
Eigen::Vector3d supportPoint(const ConvexShape& shape, const Eigen::Vector3d& direction);

// Exact; the gradient in W.
DistanceSample sampleDistance(const ConvexShape& shape, const Eigen::Vector3d& point);

std::vector<Eigen::Vector3d> boxCorners(const ConvexShape& box);

// The flat face whose outward normal is nearest to `direction` (a box always has one, a cylinder its caps). A
// cap is a polygon inscribed in the rim, the lowest rim point along `direction` among its corners.
Face faceTowards(const ConvexShape& shape, const Eigen::Vector3d& direction);

// What would touch a plane that comes from `direction`: a face, or a cylinder's side line. Contains the support
// point always.
Polygon pieceTowards(const ConvexShape& shape, const Eigen::Vector3d& direction);

// The edge or side line that would touch something thin from `direction`: of a box the one most perpendicular
// to `direction`, of a cylinder its side line or, if it is tilted, one rim point.
Polygon edgeTowards(const ConvexShape& shape, const Eigen::Vector3d& direction);

}  // namespace monolith
