#include "scene/urdf_joint.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/shown_vector.h"
#include "scene/urdf_pose.h"

namespace monolith {
namespace {

const char* typeName(int type) {
  switch (type) {
    case urdf::Joint::REVOLUTE:
      return "revolute";
    case urdf::Joint::CONTINUOUS:
      return "continuous";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    case urdf::Joint::FIXED:
      return "fixed";
    default:
      return "unknown";
  }
}

std::string shown(const std::string& what, double value) {
  std::ostringstream text;
  text << what << " " << value;
  return text.str();
}

double readNotNegative(const std::string& what, double value, UrdfErrors& errors) {
  if (!std::isfinite(value) || value < 0.0) errors.add(shown(what, value), "expected a finite number >= 0");
  return value;
}

void readLimits(const urdf::Joint& joint, const std::string& label, JointDescription& description, UrdfErrors& errors) {
  const bool continuous = joint.type == urdf::Joint::CONTINUOUS;
  if (!joint.limits) {
    if (!continuous) errors.add(label + " limit: missing", "expected <limit> with lower, upper, effort and velocity");
    return;
  }
  description.most_effort = readNotNegative(label + " limit: effort", joint.limits->effort, errors);
  if (continuous) return;
  const double lower = joint.limits->lower, upper = joint.limits->upper;
  if (!std::isfinite(lower) || !std::isfinite(upper) || lower > upper) {
    return errors.add(shown(label + " limit: lower", lower) + shown(", upper", upper),
                      "expected finite numbers, lower at most upper");
  }
  description.lower = lower;
  description.upper = upper;
}

}  // namespace

JointDescription readUrdfJoint(const urdf::Joint& joint, const Eigen::Isometry3d& X_PL, UrdfErrors& errors) {
  const std::string label = "joint \"" + joint.name + "\"";
  JointDescription description;
  description.name = joint.name;
  description.X_PJ = X_PL * toEigen(joint.parent_to_joint_origin_transform);
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      description.type = JointType::kRevolute;
      break;
    case urdf::Joint::PRISMATIC:
      description.type = JointType::kPrismatic;
      break;
    default:
      errors.add(label + ": type " + typeName(joint.type), "expected fixed, revolute, continuous or prismatic");
      return description;
  }
  if (joint.mimic) {
    errors.add(label + ": mimic of joint \"" + joint.mimic->joint_name + "\"",
               "expected none, every joint moves by itself");
  }
  if (!description.X_PJ.matrix().allFinite()) errors.add(label + ": origin", "expected finite coordinates");
  const Eigen::Vector3d axis = toEigen(joint.axis);
  description.axis = axis.stableNormalized();
  if (!description.axis.allFinite() || !(description.axis.norm() > 0.5)) {
    errors.add(label + ": axis " + shownVector(axis), "expected finite numbers, not all 0");
  }
  readLimits(joint, label, description, errors);
  if (joint.dynamics) {
    description.damping = readNotNegative(label + " dynamics: damping", joint.dynamics->damping, errors);
    description.friction = readNotNegative(label + " dynamics: friction", joint.dynamics->friction, errors);
  }
  description.position = std::clamp(0.0, description.lower, description.upper);
  return description;
}

}  // namespace monolith
