#pragma once
// Motion of a rigid body between coupled solves: I d(omega)/dt + omega x (I omega) = torque, and the pose by the
// exponential map.

#include "rigid/rigid_body.h"

namespace monolith {

struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N, in W
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m, in W, about the centre of mass
};

// v*, from which a step starts: the twist after gravity, gyroscopic terms and a wrench over dt, liquid and contact left
// out. Implicit midpoint in the gyroscopic term: energy is kept when torque-free, at any spin. The twist of a body
// that is not free comes back unchanged.
Vector6d freeTwist(const RigidBody& body, const Eigen::Vector3d& gravity, const Wrench& wrench, double dt);

// Moves the pose by the body's twist over dt: exponential map about the centre of mass, of a prescribed body about the
// origin of its frame, quaternion made unit. A body that is prescribed to move in place stays.
void advancePose(RigidBody& body, double dt);

// A free body over a step of second order (simulation/time_stepping.h), but for what the solve adds.
struct FreeMotion {
  Vector6d twist = Vector6d::Zero();                                // v*
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();         // at the end, if `expected` is what the solve adds
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();       // likewise
};

// Momentum and angular momentum are changed by gravity and `held` over dt. `expected`: torque that the solve is going
// to add, an estimate that only the gyroscopic term and the orientation follow. Torque-free, energy is kept at any
// spin.
FreeMotion freeMotion(const RigidBody& body, const Eigen::Vector3d& gravity, const Wrench& held,
                      const Eigen::Vector3d& expected, double dt);

// Gives the body the twist that was solved for, and moves it by the mean of that and the one it had (trapezoidal rule).
void finishMotion(const FreeMotion& motion, const Vector6d& twist, double dt, RigidBody& body);

// Twist of the centre of mass that a prescribed body has at time t.
Vector6d prescribedTwist(const RigidBody& body, double time);
// Its mean from then on over dt: advancePose() by it ends where the motion does, however long dt is; where the axis of
// rotation changes, by second order.
Vector6d meanPrescribedTwist(const RigidBody& body, double time, double dt);

// J
double kineticEnergy(const RigidBody& body);

// The body at time 0. `distance_resolution` (m): see geometry/shape.h.
RigidBody makeRigidBody(const BodyDescription& description, double distance_resolution);

}  // namespace monolith
