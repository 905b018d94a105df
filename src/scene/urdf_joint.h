#pragma once
// Movable joint of a URDF -> JointDescription: revolute, continuous and prismatic ones. Velocity limits are not read.

#include <urdf_model/joint.h>

#include "scene/scene.h"
#include "scene/urdf_errors.h"

namespace monolith {

// X_PL: frame of the parent link in the parent body's. The position is the one within the limits that is nearest to 0.
// `parent` is left to the caller. What is wrong is added to the errors.
JointDescription readUrdfJoint(const urdf::Joint& joint, const Eigen::Isometry3d& X_PL, UrdfErrors& errors);

}  // namespace monolith
