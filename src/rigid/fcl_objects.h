#pragma once
// Collision shapes as FCL objects: broad phase for all of them, closest pairs for meshes.

#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <memory>

#include "geometry/shape.h"

namespace monolith {

// FCL's binaries are built for the baseline processor, where Eigen aligns to 16 bytes. With -march=native it would
// align to 32 or 64 here: other offsets of members, and crashes.
static_assert(alignof(Eigen::Isometry3d) == 16,
              "compile everything with -DEIGEN_MAX_STATIC_ALIGN_BYTES=16, as FCL's binaries are");

// Its bounding box reaches a margin beyond the shape: pairs that the broad phase finds are those that may be
// within twice that.
class InflatedObject : public fcl::CollisionObjectd {
 public:
  using fcl::CollisionObjectd::CollisionObjectd;

  void place(const Eigen::Isometry3d& X_WG, double inflation) {
    setTransform(X_WG);
    computeAABB();
    aabb.expand(Eigen::Vector3d::Constant(inflation));
  }
};

std::shared_ptr<fcl::CollisionGeometryd> makeCollisionGeometry(const Shape& shape);

struct ClosestPair {
  double distance;  // m; negative: they touch or overlap, and the points mean nothing
  Eigen::Vector3d on_a, on_b;
};

// The closest pair of points of two shapes if it is closer than `most` (m), which cuts the search short; else its
// distance is `most`, and the points mean nothing.
ClosestPair findClosestPair(const fcl::CollisionGeometryd& a, const Eigen::Isometry3d& X_WA,
                            const fcl::CollisionGeometryd& b, const Eigen::Isometry3d& X_WB, double most);

}  // namespace monolith
