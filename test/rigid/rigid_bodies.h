#pragma once
// Bodies for the tests of this folder.

#include <cmath>
#include <memory>
#include <random>

#include "rigid/contact.h"
#include "rigid/integration.h"

namespace monolith::test {

inline Shape boxShape(const Eigen::Vector3d& size) {
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = size;
  return shape;
}

inline Shape sphereShape(double radius) {
  Shape shape;
  shape.kind = Shape::Kind::kSphere;
  shape.radius = radius;
  return shape;
}

inline Shape cylinderShape(double radius, double length) {
  Shape shape;
  shape.kind = Shape::Kind::kCylinder;
  shape.radius = radius;
  shape.length = length;
  return shape;
}

inline Shape meshShape(std::vector<Eigen::Vector3d> vertices, std::vector<Eigen::Vector3i> triangles) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = std::move(vertices);
  mesh->triangles = std::move(triangles);
  Shape shape;
  shape.kind = Shape::Kind::kMesh;
  shape.mesh = mesh;
  return shape;
}

// A box as twelve triangles.
inline Shape boxMesh(const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i) {
    vertices.emplace_back(
        0.5 * size.cwiseProduct(Eigen::Vector3d(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0)));
  }
  return meshShape(vertices, {{0, 2, 1},
                              {1, 2, 3},
                              {4, 5, 6},
                              {5, 7, 6},
                              {0, 1, 4},
                              {1, 5, 4},
                              {2, 6, 3},
                              {3, 6, 7},
                              {0, 4, 2},
                              {2, 4, 6},
                              {1, 3, 5},
                              {3, 7, 5}});
}

// A torus about z: `around` quadrilaterals along the ring times `across` of the tube, one row of vertices lowest.
inline Shape ringMesh(double radius, double tube, int around, int across) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * M_PI * i / around, v = 2.0 * M_PI * j / across - 0.5 * M_PI;
      const double r = radius + tube * std::cos(v);
      vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
      const int a = i * across + j, b = i * across + (j + 1) % across;
      const int c = (i + 1) % around * across + j, d = (i + 1) % around * across + (j + 1) % across;
      triangles.emplace_back(a, c, b);
      triangles.emplace_back(b, c, d);
    }
  }
  return meshShape(vertices, triangles);
}

// An L (seen along y): the block [0, 2] x [0, 1] x [0, 2] without ]1, 2] x . x ]1, 2]. Not convex.
inline Shape cornerMesh() {
  std::vector<Eigen::Vector3d> vertices;
  for (const double y : {0.0, 1.0})
    for (const auto& [x, z] : std::vector<std::pair<double, double>>{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})
      vertices.emplace_back(x, y, z);
  std::vector<Eigen::Vector3i> triangles{{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  for (int i = 0; i < 4; ++i) {
    triangles.emplace_back(triangles[i][0] + 6, triangles[i][2] + 6, triangles[i][1] + 6);
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    triangles.emplace_back(i, i + 6, j);
    triangles.emplace_back(j, i + 6, j + 6);
  }
  return meshShape(vertices, triangles);
}

inline Eigen::Isometry3d pose(const Eigen::Vector3d& position,
                              const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  Eigen::Isometry3d X(rotation);
  X.translation() = position;
  return X;
}

inline Eigen::Quaterniond turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis.normalized()));
}

inline RigidBody makeBody(const std::string& name, const std::vector<Shape>& shapes, const Eigen::Isometry3d& X_WB,
                          BodyMotion motion = BodyMotion::kFree) {
  RigidBody body;
  body.name = name;
  body.shapes = shapes;
  body.motion = motion;
  body.q_WB = Eigen::Quaterniond(X_WB.linear());
  body.p_WBcm = X_WB.translation();
  return body;
}

inline TankWalls farWalls() {
  TankWalls walls;
  walls.inside = Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-1e3), Eigen::Vector3d::Constant(1e3));
  return walls;
}

inline std::vector<Contact> detect(const std::vector<RigidBody>& bodies, double margin,
                                   const TankWalls& walls = farWalls()) {
  return ContactDetector(bodies, walls).detect(bodies, margin);
}

inline std::vector<Contact> detectPair(const Shape& a, const Eigen::Isometry3d& X_WA, const Shape& b,
                                       const Eigen::Isometry3d& X_WB, double margin) {
  return detect({makeBody("a", {a}, X_WA), makeBody("b", {b}, X_WB)}, margin);
}

// True if `point` is within the horizontal convex hull of the contact points, to within `slack`.
inline bool supports(const std::vector<Contact>& contacts, const Eigen::Vector3d& point, double slack = 1e-9) {
  for (int i = 0; i < 720; ++i) {
    const Eigen::Vector3d direction(std::cos(i * M_PI / 360.0), std::sin(i * M_PI / 360.0), 0.0);
    double farthest = -1e300;
    for (const Contact& contact : contacts) farthest = std::max(farthest, direction.dot(contact.point - point));
    if (farthest < -slack) return false;
  }
  return true;
}

inline double leastGap(const std::vector<Contact>& contacts) {
  double least = 1e300;
  for (const Contact& contact : contacts) least = std::min(least, contact.gap);
  return least;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Eigen::Vector3d inCube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Eigen::Quaterniond rotation() {
    Eigen::Vector4d q;
    do q = Eigen::Vector4d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    while (q.norm() > 1.0 || q.norm() < 0.1);
    return Eigen::Quaterniond(q.normalized());
  }

 private:
  std::mt19937 engine_;  // its sequence is fixed by the standard
};

}  // namespace monolith::test
