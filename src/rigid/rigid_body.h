#pragma once
// State and mass properties of one rigid body at a moment. World frame W; the twist is that of the centre of
// mass Bcm, in world axes: v = (linear m/s, angular rad/s) in R^6.

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/shape.h"
#include "scene/scene.h"

namespace monolith {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct RigidBody {
  // constant
  std::string name;
  BodyMotion motion = BodyMotion::kFree;
  PrescribedMotion prescribed;
  std::optional<JointDescription> joint;                      // by which it hangs on another
  bool self_collision = false;                                // with others that joints connect it to, not next to it
  double mass = 1.0;                                          // kg
  Eigen::Vector3d p_BBcm = Eigen::Vector3d::Zero();           // m
  Eigen::Matrix3d inertia_Bcm = Eigen::Matrix3d::Identity();  // kg m^2, axes of B
  std::vector<Shape> shapes;
  std::shared_ptr<const SignedDistance> distance;             // union of the shapes, frame B
  std::optional<Displacement> displacement;                   // likewise, where it is known
  double thinnest = std::numeric_limits<double>::infinity();  // m, of its walls, if it has any
  // state
  Eigen::Vector3d p_WBcm = Eigen::Vector3d::Zero();           // m
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  Vector6d twist = Vector6d::Zero();
  double joint_position = 0.0;  // rad, m
  double joint_velocity = 0.0;  // rad/s, m/s

  // A joint whose motion is not prescribed.
  bool hasFreeJoint() const { return joint && !joint->prescribed; }
  Eigen::Isometry3d pose() const {                            // X_WB, of the body frame
    Eigen::Isometry3d X_WB(q_WB);
    X_WB.translation() = p_WBcm - q_WB * p_BBcm;
    return X_WB;
  }
  Eigen::Matrix3d worldInertia() const {
    const Eigen::Matrix3d R = q_WB.toRotationMatrix();
    return R * inertia_Bcm * R.transpose();
  }
  // m, of a sphere about its centre of mass that holds it.
  double radius() const {
    const Eigen::AlignedBox3d box = distance->bounds().translated(-p_BBcm);
    return box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
  }
  // m/s, that no point of it exceeds with this twist.
  double fastestPoint(const Vector6d& of_twist) const {
    return of_twist.head<3>().norm() + radius() * of_twist.tail<3>().norm();
  }
  // m, that any of its points is from where it was at a pose X_WB.
  double distanceFrom(const Eigen::Isometry3d& X_WB) const {
    const Eigen::Isometry3d now = pose();
    const Eigen::AlignedBox3d box = distance->bounds();
    double farthest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      farthest = std::max(farthest, (now * p - X_WB * p).norm());
    }
    return farthest;
  }
  // Velocity of the material point that is now at p_W.
  Eigen::Vector3d velocityAt(const Eigen::Vector3d& p_W) const {
    return twist.head<3>() + twist.tail<3>().cross(p_W - p_WBcm);
  }
};

}  // namespace monolith
