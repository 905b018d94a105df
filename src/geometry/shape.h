#pragma once
// A collision shape as the URDF gives it, placed in the frame of its body. Dimensions as in the URDF
// specification: a box by its full edge lengths, a cylinder by radius and length along its own z axis.

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/signed_distance.h"

namespace monolith {

// Closed, outward-oriented triangle surface. Vertices in m, in the frame of the shape.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::string source;  // the file it came from, for messages
};

struct Shape {
  enum class Kind { kBox, kSphere, kCylinder, kMesh };

  Kind kind = Kind::kBox;
  Eigen::Isometry3d X_BG = Eigen::Isometry3d::Identity();  // pose of the shape G in its body B
  Eigen::Vector3d box_size = Eigen::Vector3d::Zero();      // m, kBox
  double radius = 0.0;                                     // m, kSphere and kCylinder
  double length = 0.0;                                     // m, kCylinder
  std::shared_ptr<const TriangleMesh> mesh;                // kMesh
  std::string name;                                        // "link/collision[0]", for messages
};

// Distance field of one shape in the shape's own frame. `resolution` (m) is the sample spacing of the
// grid that a mesh is baked into; the other kinds are exact and ignore it.
std::shared_ptr<const SignedDistance> makeSignedDistance(const Shape& shape, double resolution);

// Distance field of the union of shapes, in the frame of the body (geometry/union_distance.h).
std::shared_ptr<const SignedDistance> makeSignedDistance(const std::vector<Shape>& shapes,
                                                         double resolution);

// Volume enclosed, m^3.
double volume(const Shape& shape);

// Volume of a solid and the centre of it: what it displaces when it is wholly in liquid.
struct Displacement {
  double volume = 0.0;                               // m^3
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
};

// Of the union of shapes, in the frame of the body; nothing where they may overlap (their bounding boxes do).
std::optional<Displacement> displacement(const std::vector<Shape>& shapes);

// Smallest box along the axes of frame A that holds the shape, its body B posed at X_AB.
Eigen::AlignedBox3d bounds(const Shape& shape, const Eigen::Isometry3d& X_AB);

}  // namespace monolith
