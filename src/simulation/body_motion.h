#pragma once
// What a step does to the bodies before and after its solve (simulation/time_stepping.h).

#include <vector>

#include "rigid/contact.h"
#include "rigid/integration.h"
#include "simulation/time_stepping.h"

namespace monolith {

struct BodyPlan {
  std::vector<RigidBody> bodies;      // as the solve has them: poses, and the twist that sticking liquid brings along
  std::vector<Vector6d> free_twists;  // v* of free bodies, the prescribed twist of others
  std::vector<FreeMotion> motion;     // second order only
  std::vector<char> closing;          // likewise
  std::vector<char> by_euler;         // likewise: bodies that are in the solve where backward Euler has them
};

// Bodies that close a gap of the contacts within dt by more than the tolerance (m), and those that share a contact with
// them: their velocities are going to jump.
std::vector<char> closingBodies(const std::vector<RigidBody>& bodies, const std::vector<Contact>& contacts, double dt,
                                double gap_tolerance);

// Bodies with a gap of at most the tolerance (m), and those that share a contact with them.
std::vector<char> touchingBodies(std::size_t count, const std::vector<Contact>& contacts, double gap_tolerance);

// Backward Euler: bodies stay where they are until they are solved for.
BodyPlan planEuler(const std::vector<RigidBody>& bodies, const Eigen::Vector3d& gravity,
                   const std::vector<Wrench>& wrenches, double time, double dt);

// What the bodies bring from the last step.
struct BodyPast {
  std::vector<Vector6d> acceleration;  // m/s^2, rad/s^2, mean
  std::vector<Wrench> liquid;          // mean
  std::vector<Wrench> contact;         // mean
};

// Second order. Bodies that are closing or touch are in the solve where they are at the start: only then do
// non-penetration and friction hold at the points where they touch; those that are closing also move as backward Euler
// has it. Points of the other contacts go with the bodies.
BodyPlan planSecondOrder(const std::vector<RigidBody>& bodies, const Eigen::Vector3d& gravity,
                         const std::vector<Wrench>& wrenches, const BodyPast& past, double time,
                         const StepWeights& weights, const std::vector<char>& closing,
                         const std::vector<char>& by_euler, std::vector<Contact>& contacts);

// Twists as solved for; moves the bodies.
void finishEuler(const std::vector<Vector6d>& twists, double dt, std::vector<RigidBody>& bodies);
void finishSecondOrder(const BodyPlan& plan, const std::vector<Vector6d>& twists, double dt,
                       std::vector<RigidBody>& bodies);

}  // namespace monolith
