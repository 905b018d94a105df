#pragma once
// Bodies that hang on others by joints: a tree, of which every body's parent comes before it. Poses follow from that of
// the tree's root and the joints' positions, so that no joint ever comes apart, twists from the root's and the joints'
// velocities:
//   v_b = X v_parent + s qdot,   X: carried along as if the two were one,   s: of the joint's axis
// (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 4; here at the centres of mass, in world axes).

#include <vector>

#include "rigid/integration.h"
#include "rigid/rigid_body.h"

namespace monolith {

// Index of the body that each hangs on in the end; of one without a joint its own.
std::vector<int> rootsOf(const std::vector<RigidBody>& bodies);

// Whether two bodies touch where they meet: not if joints connect them, unless both have self_collision, and then not
// neighbours.
bool mayTouch(const std::vector<RigidBody>& bodies, const std::vector<int>& roots, std::size_t a, std::size_t b);

// s: twist of body b (m/s, rad/s, at its centre of mass) while its joint moves at 1 rad/s or 1 m/s and its parent
// rests.
Vector6d jointTwist(const RigidBody& body);

// X: twist of the parent -> twist of b, as if they were one body.
Matrix6d carryMatrix(const std::vector<RigidBody>& bodies, std::size_t b);

// s^+ with s^+ s = 1: the joint's velocity is s^+ (v_b - X v_parent).
Vector6d jointRow(const RigidBody& body);

// rad/s, m/s, of bodies in these poses with other twists; 0 of one without a joint.
double jointVelocity(const std::vector<RigidBody>& bodies, std::size_t b, const std::vector<Vector6d>& twists);

// Poses of the bodies with joints, from those of their roots and the joints' positions; of images that repeat after
// `period` (m; 0: none) the one nearest to where the body was.
void placeOnJoints(const Eigen::Vector3d& period, std::vector<RigidBody>& bodies);
// Their twists, from the roots' and the joints' velocities.
void moveWithJoints(std::vector<RigidBody>& bodies);

// One end of a joint's range: what it keeps is gap >= 0.
struct JointStop {
  int body = 0;
  double sign = 1.0;    // the gap grows with the joint's position (1: the lower end) or falls (-1)
  double gap = 0.0;     // rad, m
  double radius = 1.0;  // see stopRadius()
};

// m/rad, at which what a joint's end stops moves; 1 of a prismatic joint.
double stopRadius(const RigidBody& body);

// All that there are: a servo may take a joint from one end to the other within a step.
std::vector<JointStop> jointStops(const std::vector<RigidBody>& bodies);

// kg m^2, kg: inertia of all that hangs on each body's joint against its motion, the parent at rest; 0 without a joint.
std::vector<double> jointInertias(const std::vector<RigidBody>& bodies);

// m/s, that no point of each body exceeds if its joint and those before it move at these speeds, their root at rest.
std::vector<double> fastestPoints(const std::vector<RigidBody>& bodies, const std::vector<double>& speeds);

// Wrench of an effort (N m, N) of body b's joint, on it; the parent feels the opposite one at the same place.
void addJointEffort(const std::vector<RigidBody>& bodies, std::size_t b, double effort, std::vector<Wrench>& wrenches);

// N m, N, along each joint's axis, of the wrench that goes through it, if `wrenches` are what joints do to each body.
std::vector<double> effortsThrough(const std::vector<RigidBody>& bodies, const std::vector<Wrench>& wrenches);

}  // namespace monolith
