#pragma once
// Motion of a rigid body between coupled solves: I d(omega)/dt + omega x (I omega) = torque, and the pose by the
// exponential map.

#include "rigid/rigid_body.h"

namespace monolith {

struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N, in W
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m, in W, about the centre of mass
};

// v* of DESIGN 1.2: the twist after gravity, gyroscopic terms and a wrench over dt, liquid and contact left
// out. Implicit midpoint in the gyroscopic term: energy is kept when torque-free, at any spin. The twist of a body
// that is not free comes back unchanged.
Vector6d freeTwist(const RigidBody& body, const Eigen::Vector3d& gravity, const Wrench& wrench, double dt);

// Moves the pose by the body's twist over dt: exponential map about the centre of mass, quaternion made unit. A body that is
// prescribed to move in place stays.
void advancePose(RigidBody& body, double dt);

// Twist of the centre of mass that a prescribed body has at time t.
Vector6d prescribedTwist(const RigidBody& body, double time);

// The body at time 0. `distance_resolution` (m): see geometry/shape.h.
RigidBody makeRigidBody(const BodyDescription& description, double distance_resolution);

}  // namespace monolith
