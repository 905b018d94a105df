#pragma once
// Vectors and poses of the URDF parser in Eigen's terms.

#include <urdf_model/pose.h>

#include <Eigen/Geometry>

namespace monolith {

inline Eigen::Vector3d toEigen(const urdf::Vector3& v) { return Eigen::Vector3d(v.x, v.y, v.z); }

inline Eigen::Isometry3d toEigen(const urdf::Pose& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)
                   .normalized()
                   .toRotationMatrix();
  X.translation() = toEigen(pose.position);
  return X;
}

}  // namespace monolith
