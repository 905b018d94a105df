#pragma once
// Signed distance of a solid: negative inside, positive outside, |gradient| = 1 almost everywhere.
// Units m; all points in the frame of the solid that owns the object.

#include <Eigen/Geometry>
#include <memory>

namespace monolith {

struct DistanceSample {
  double distance;           // m, negative inside
  Eigen::Vector3d gradient;  // unit, points out of the solid
};

class SignedDistance {
 public:
  virtual ~SignedDistance() = default;
  virtual DistanceSample sample(const Eigen::Vector3d& point) const = 0;
  virtual double distance(const Eigen::Vector3d& point) const { return sample(point).distance; }
  // Axis-aligned box that holds the whole solid.
  virtual Eigen::AlignedBox3d bounds() const = 0;
};

}  // namespace monolith
