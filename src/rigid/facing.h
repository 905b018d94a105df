#pragma once
// Which face a corner rests on. The gradient of the distance says little where the corner is flush with an edge:
// a corner 1 nm beside a table's edge would be pushed sideways. Of the faces that are the nearest one to
// within a slack, the one that faces the corner most is taken.

#include <Eigen/Core>
#include <cmath>

#include "geometry/signed_distance.h"

namespace monolith {

class FacingChoice {
 public:
  FacingChoice(const DistanceSample& nearest, const Eigen::Vector3d& corner_normal, double slack)
      : nearest_(nearest), corner_normal_(corner_normal), slack_(slack) {}

  // A face with its outward normal; the point is `height` above its plane and its foot `beside` the face (m).
  void offer(const Eigen::Vector3d& normal, double height, double beside) {
    const double facing = -normal.dot(corner_normal_);
    if (beside > slack_ || std::abs(height - nearest_.distance) > slack_) return;
    if (facing > facing_ + 1e-9) {
      facing_ = facing;
      face_ = {height, normal};
    }
  }

  // False if what is nearest faces away from the corner, which then cannot be what touches it.
  bool take(DistanceSample& chosen) const {
    const double facing = -nearest_.gradient.dot(corner_normal_);
    const bool deep = nearest_.distance < -2.0 * slack_;
    const bool use_face = facing_ > kLeastFacing && facing_ >= facing;
    chosen = use_face ? face_ : nearest_;
    return use_face || facing > 0.0 || deep;
  }

 private:
  static constexpr double kLeastFacing = 0.1;

  DistanceSample nearest_;
  Eigen::Vector3d corner_normal_;
  double slack_;
  double facing_ = 0.0;
  DistanceSample face_{0.0, Eigen::Vector3d::UnitZ()};
};

}  // namespace monolith
