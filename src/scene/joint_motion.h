#pragma once
// Where a joint's position puts the body that hangs on it.

#include "scene/scene.h"

namespace monolith {

// X_PB: frame of the body in its parent's, at a position (rad, m) of the joint.
inline Eigen::Isometry3d jointPose(const JointDescription& joint, double position) {
  Eigen::Isometry3d X_JB = Eigen::Isometry3d::Identity();
  switch (joint.type) {
    case JointType::kRevolute:
      X_JB.linear() = Eigen::AngleAxisd(position, joint.axis).toRotationMatrix();
      break;
    case JointType::kPrismatic:
      X_JB.translation() = position * joint.axis;
      break;
  }
  return joint.X_PJ * X_JB;
}

}  // namespace monolith
