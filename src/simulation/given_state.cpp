// What is given to a simulation while it runs: wrenches, commands, states of bodies and liquid.

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "fluid/advection.h"
#include "rigid/overlap.h"
#include "scene/shown_vector.h"
#include "simulation/simulation_impl.h"

namespace monolith {
namespace {

// Of a cell. What overlaps is pushed apart, and the speed that it takes stays; a state that is set may be one that was
// simulated: as much as contacts leave.
constexpr double kOverlapTolerance = 0.05;

}  // namespace

void Simulation::setWrench(int body, const Wrench& wrench) {
  if (body < 0 || body >= static_cast<int>(impl_->wrenches.size())) {
    throw std::invalid_argument("body index " + std::to_string(body) + ": expected 0 to " +
                                std::to_string(static_cast<int>(impl_->wrenches.size()) - 1));
  }
  if (!wrench.force.allFinite() || !wrench.torque.allFinite()) {
    throw std::invalid_argument("wrench on '" + impl_->state.bodies[body].name + "': expected finite numbers");
  }
  impl_->wrenches[body] = wrench;
}

// What hangs on a body, to where that is and as it moves.
void Simulation::Impl::moveAssembly(int root, std::vector<RigidBody>& bodies) const {
  std::vector<RigidBody> moved = bodies;
  placeOnJoints(walls.period(), moved);
  moveWithJoints(moved);
  const std::vector<int> roots = rootsOf(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].joint || roots[b] != root) continue;
    bodies[b] = moved[b];
    bodies[b].p_WBcm = walls.imageInside(bodies[b].p_WBcm);
  }
}

void Simulation::Impl::requireJoint(int body) const {
  const std::vector<RigidBody>& bodies = state.bodies;
  if (body >= 0 && body < static_cast<int>(bodies.size()) && bodies[body].hasFreeJoint()) return;
  throw std::invalid_argument("joint of body index " + std::to_string(body) +
                              ": expected a body that hangs on another by a joint whose motion is not prescribed");
}

void Simulation::setJointCommand(int body, const JointCommand& command) {
  impl_->requireJoint(body);
  const std::vector<RigidBody>& bodies = impl_->state.bodies;
  if (!std::isfinite(command.effort) || !std::isfinite(command.position) || !std::isfinite(command.velocity)) {
    throw std::invalid_argument("command for joint '" + bodies[body].joint->name + "': expected finite numbers");
  }
  impl_->commands[body] = command;
}

// Takes the state that was given to `changed`, and to what hangs on it.
void Simulation::Impl::setBodies(std::vector<RigidBody> bodies, int changed) {
  const int root = rootsOf(bodies)[changed];
  moveAssembly(root, bodies);
  const std::string& name = bodies[changed].name;
  for (const RigidBody& body : bodies) {
    if (body.p_WBcm.allFinite() && body.twist.allFinite() && std::isfinite(kineticEnergy(body))) continue;
    throw std::invalid_argument("state of '" + body.name + "': centre of mass at " + shownVector(body.p_WBcm) +
                                " m, its velocity " + shownVector(body.twist.head<3>()) +
                                " m/s: expected finite numbers, the energy too");
  }
  const std::string overlaps = describeOverlaps(bodies, walls, kOverlapTolerance * grid.h, root);
  if (!overlaps.empty()) {
    throw std::invalid_argument("state of '" + name +
                                "': expected a pose inside the tank and clear of other bodies:\n" + overlaps);
  }
  state.bodies = std::move(bodies);
  state.euler_steps = kStepsAfterSet;
  prepareGeometry();
  measureState(report);
}

void Simulation::setBodyState(int body, const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& velocity,
                              const Eigen::Vector3d& angular_velocity) {
  Impl& m = *impl_;
  if (body < 0 || body >= static_cast<int>(m.state.bodies.size())) {
    throw std::invalid_argument("body index " + std::to_string(body) + ": expected 0 to " +
                                std::to_string(static_cast<int>(m.state.bodies.size()) - 1));
  }
  const std::string& name = m.state.bodies[body].name;
  if (!X_WB.matrix().allFinite() || !velocity.allFinite() || !angular_velocity.allFinite()) {
    throw std::invalid_argument("state of '" + name + "': expected finite numbers");
  }
  if (m.state.bodies[body].joint) {
    throw std::invalid_argument("state of '" + name + "': it hangs on '" +
                                m.state.bodies[rootsOf(m.state.bodies)[body]].name +
                                "', expected that one, or a body without a joint");
  }
  std::vector<RigidBody> bodies = m.state.bodies;
  RigidBody& moved = bodies[body];
  moved.q_WB = Eigen::Quaterniond(X_WB.linear()).normalized();
  const Eigen::Vector3d to_centre = moved.q_WB * moved.p_BBcm;
  moved.p_WBcm = m.walls.imageInside(X_WB.translation() + to_centre);
  moved.twist.head<3>() = velocity + angular_velocity.cross(to_centre);
  moved.twist.tail<3>() = angular_velocity;
  m.setBodies(std::move(bodies), body);
}

void Simulation::setJointStates(const std::vector<JointState>& states) {
  Impl& m = *impl_;
  std::vector<RigidBody> bodies = m.state.bodies;
  const std::vector<int> roots = rootsOf(bodies);
  std::set<int> named;
  for (const JointState& set : states) {
    m.requireJoint(set.body);
    if (roots[set.body] != roots[states.front().body]) {
      throw std::invalid_argument("joints of '" + bodies[set.body].name + "' and '" + bodies[states.front().body].name +
                                  "': expected those of one robot");
    }
    const JointDescription& joint = *bodies[set.body].joint;
    // As far beyond an end as contact may leave it.
    const double beyond = kOverlapTolerance * m.grid.h / stopRadius(bodies[set.body]);
    if (!std::isfinite(set.position) || !std::isfinite(set.velocity) || set.position < joint.lower - beyond ||
        set.position > joint.upper + beyond) {
      std::ostringstream text;
      text << "state of joint '" << joint.name << "': position " << set.position << ", velocity " << set.velocity
           << ": expected finite numbers, the position from " << joint.lower << " to " << joint.upper;
      throw std::invalid_argument(text.str());
    }
    if (!named.insert(set.body).second) {
      throw std::invalid_argument("state of joint '" + joint.name + "': given twice, expected once");
    }
    bodies[set.body].joint_position = set.position;
    bodies[set.body].joint_velocity = set.velocity;
  }
  // Its whole robot is looked at.
  if (!states.empty()) m.setBodies(std::move(bodies), states.front().body);
}

void Simulation::setLiquidVelocity(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity) {
  FaceField<double> faces;
  setVelocity(impl_->grid, velocity, faces);
  SimulationState& state = impl_->state;
  std::vector<Vector6d> stuck_twists;
  for (const RigidBody& body : state.bodies) {
    // Of a sphere that is its surface.
    stuck_twists.push_back(rigidMotion(velocity, body.p_WBcm, body.radius() / std::sqrt(3.0)));
    if (!stuck_twists.back().allFinite()) {
      throw std::invalid_argument("velocity of the liquid around '" + body.name + "': expected finite numbers");
    }
  }
  extrapolateVelocity(impl_->grid.lattice, 0, impl_->noSlip(), state.known, {&faces});  // beyond the walls only
  state.coupled.velocity = std::move(faces);
  state.liquid_speed = largestSpeed(state.coupled.velocity);
  state.stuck_twists = std::move(stuck_twists);
  state.euler_steps = kStepsAfterSet;
}

}  // namespace monolith
