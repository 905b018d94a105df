#pragma once
// What a step does to the bodies before and after its solve (simulation/time_stepping.h).

#include <string>
#include <vector>

#include "rigid/articulation.h"
#include "rigid/contact.h"
#include "rigid/integration.h"
#include "simulation/time_stepping.h"

namespace monolith {

struct BodyPlan {
  std::vector<RigidBody> bodies;      // as the solve has them: poses, and the twist that sticking liquid brings along
  std::vector<Vector6d> free_twists;  // v* of free bodies, the prescribed twist of others
  std::vector<double> joint_end;      // rad, m, where a prescribed joint comes to
  std::vector<FreeMotion> motion;     // second order only
  std::vector<char> closing;          // likewise
};

// Bodies that close a gap of the contacts or come to the end of a joint within dt by more than the tolerance (m), and
// those that free ones of them touch or hold by joints: their velocities are going to jump.
std::vector<char> closingBodies(const std::vector<RigidBody>& bodies, const std::vector<Contact>& contacts,
                                const std::vector<JointStop>& stops, double dt, double gap_tolerance);

// Backward Euler: bodies stay where they are until they are solved for.
BodyPlan planEuler(const std::vector<RigidBody>& bodies, const Eigen::Vector3d& gravity,
                   const std::vector<Wrench>& wrenches, double time, double dt);

// What the bodies bring from the last step.
struct BodyPast {
  std::vector<Vector6d> acceleration;  // m/s^2, rad/s^2, mean
  std::vector<Wrench> liquid;          // mean
  std::vector<Wrench> contact;         // mean
  std::vector<Wrench> joints;          // mean, of what holds them and what is implicit in them
};

// Second order. Bodies that are closing stay where they are until they are solved for. Points of the contacts go with
// the bodies.
BodyPlan planSecondOrder(const std::vector<RigidBody>& bodies, const Eigen::Vector3d& gravity,
                         const std::vector<Wrench>& wrenches, const BodyPast& past, double time,
                         const StepWeights& weights, const std::vector<char>& closing, const Eigen::Vector3d& period,
                         std::vector<Contact>& contacts);

// Twists as solved for; moves the bodies.
void finishEuler(const BodyPlan& plan, const std::vector<Vector6d>& twists, double dt, const Eigen::Vector3d& period,
                 std::vector<RigidBody>& bodies);
// Closing bodies move by their new twist, for which non-penetration was solved; where some are to rebound, also by as
// much of the old one, at most half, as leaves the contacts open: so that they do it from the surface, not from above
// it.
void finishSecondOrder(const BodyPlan& plan, const std::vector<Contact>& contacts, bool rebound,
                       const std::vector<Vector6d>& twists, double dt, const Eigen::Vector3d& period,
                       std::vector<RigidBody>& bodies);

// Names what the solve's tolerance let through in a step of length dt, by how much and what was expected: a free body
// that is out of a wall after it, or two that it brought into one another along one of the contacts, deeper than
// `allowed` (m) and deeper than before by more than prescribed bodies, which nothing stops, press it by contact. Empty
// if there is none. Where speeds are absurd, a residual that is small beside them still is a long way.
std::string describeIntrusion(const BodyPlan& plan, const std::vector<Contact>& contacts, const TankWalls& walls,
                              const std::vector<Vector6d>& twists, double dt, double allowed,
                              const std::vector<RigidBody>& before, const std::vector<RigidBody>& after);

// Names the wall that a prescribed body has been driven out through by more than `allowed` (m), and how far. Empty if
// none.
std::string describeDeparture(const RigidBody& body, const TankWalls& walls, double allowed);

}  // namespace monolith
