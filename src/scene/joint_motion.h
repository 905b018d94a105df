#pragma once
// Where a joint's position puts the body that hangs on it, and how one that is prescribed moves.

#include "scene/oscillation.h"
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

// rad/s, m/s, at a time, and the mean from then on over dt.
inline double prescribedVelocity(const PrescribedJointMotion& motion, double time) {
  return motion.rate + motion.amplitude * oscillation(motion.frequency, motion.phase, time);
}
inline double meanPrescribedVelocity(const PrescribedJointMotion& motion, double time, double dt) {
  return motion.rate + motion.amplitude * meanOscillation(motion.frequency, motion.phase, time, dt);
}

}  // namespace monolith
