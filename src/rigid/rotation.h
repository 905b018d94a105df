#pragma once
// The exponential map of SO(3) and the gyroscopic equation of a torque-loaded body in its own frame.

#include <Eigen/Geometry>

namespace monolith {

// Unit quaternion of the rotation by |rotation| rad about rotation/|rotation|; exact at zero as well.
Eigen::Quaterniond exponential(const Eigen::Vector3d& rotation);

// One implicit midpoint step of  I d(omega)/dt + omega x (I omega) = torque  in body axes (omega rad/s, I kg m^2,
// torque N m, held). Without torque it keeps omega.(I omega) and |I omega| to round-off for any dt.
//
// Newton; where it does not converge over dt at once the step is halved, down to dt/1024. What is left then
// is taken without the gyroscopic term, which keeps the energy too. The inertia must be positive definite.
Eigen::Vector3d gyroscopicStep(const Eigen::Matrix3d& inertia, const Eigen::Vector3d& angular_velocity,
                               const Eigen::Vector3d& torque, double dt);

}  // namespace monolith
