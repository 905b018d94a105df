#include "scene/joint_placement.h"

#include "scene/joint_motion.h"

namespace monolith {

void placeOnParent(const BodyDescription& parent, BodyDescription& body) {
  JointDescription& joint = *body.joint;
  if (joint.prescribed) joint.velocity = prescribedVelocity(*joint.prescribed, 0.0);
  body.X_WB = parent.X_WB * jointPose(joint, joint.position);
  body.angular_velocity = parent.angular_velocity;
  body.velocity = parent.velocity + parent.angular_velocity.cross(body.X_WB.translation() - parent.X_WB.translation());
  const Eigen::Vector3d along_axis = joint.velocity * (body.X_WB.linear() * joint.axis);
  (joint.type == JointType::kRevolute ? body.angular_velocity : body.velocity) += along_axis;
}

}  // namespace monolith
