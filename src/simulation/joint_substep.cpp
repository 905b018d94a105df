// What joints do in a sub-step: their drives in its solve, and what of them goes on into the next one.

#include <algorithm>

#include "simulation/simulation_impl.h"

namespace monolith {
namespace {

// Of a free body by a wrench over dt.
Vector6d twistChange(const RigidBody& body, const Wrench& wrench, double dt) {
  Vector6d out = Vector6d::Zero();
  if (body.motion != BodyMotion::kFree) return out;
  out.head<3>() = dt / body.mass * wrench.force;
  out.tail<3>() = dt * body.worldInertia().ldlt().solve(wrench.torque);
  return out;
}

}  // namespace

// From outside, held over the step.
std::vector<Wrench> Simulation::Impl::actingWrenches() const {
  std::vector<Wrench> out = wrenches;
  for (std::size_t b = 0; b < out.size(); ++b) {
    const double effort = JointDrives::heldEffort(state.bodies[b], commands[b]);
    if (effort != 0.0) addJointEffort(state.bodies, b, effort, out);
  }
  return out;
}

// m/s, that servos may bring a body to within a step.
double Simulation::Impl::servoSpeed(double dt) const {
  const JointDrives drives(state.bodies, commands, eulerWeights(dt), state.joint_modes);
  std::vector<double> speeds;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) speeds.push_back(drives.fastest(b));
  const std::vector<double> fastest = fastestPoints(state.bodies, speeds);
  return fastest.empty() ? 0.0 : *std::max_element(fastest.begin(), fastest.end());
}

// What joints' drives do depends on the motion where they are limited: solved again until it is what was assumed.
CoupledReport Simulation::Impl::solveWithDrives(const StepWeights& w, JointDrives& drives,
                                                const std::function<CoupledReport(FaceField<double>&)>& solve) {
  const std::vector<Vector6d> free_twists = plan.free_twists;
  const std::size_t count = state.bodies.size();
  CoupledReport all;
  for (int round = 0; round < drives.mostRounds(); ++round) {
    if (round > 0) system.changeJointResistance(drives.resistances());
    std::vector<Wrench> efforts(count);
    for (std::size_t b = 0; b < count; ++b) {
      const double effort = drives.effort(b);
      if (effort != 0.0) addJointEffort(plan.bodies, b, effort, efforts);
    }
    for (std::size_t b = 0; b < count; ++b) {
      plan.free_twists[b] = free_twists[b] + twistChange(plan.bodies[b], efforts[b], w.dt);
    }
    FaceField<double> again;
    if (drives.limited()) again = scratch.free_velocity;
    CoupledReport report = solve(drives.limited() ? again : scratch.free_velocity);
    plan.free_twists = free_twists;
    report.iterations += all.iterations;
    report.solves += all.solves;
    report.friction_iterations += all.friction_iterations;
    all = report;
    if (all.status != SolveStatus::kConverged) return all;
    std::vector<double> velocities(count);
    for (std::size_t b = 0; b < count; ++b) velocities[b] = jointVelocity(plan.bodies, b, scratch.other.twists);
    scratch.joint_modes = drives.modes();
    if (!drives.limited() || drives.agree(velocities)) return all;
  }
  all.status = SolveStatus::kNotConverged;
  all.message = "what servos and friction do in the joints did not settle in " + std::to_string(all.solves) + " solves";
  return all;
}

// Impulses of the joints on each body: what the solve adds to its momentum and neither liquid nor contact does. What
// next step carries on is that but for what sets in and ends at once, stops and friction.
void Simulation::Impl::takeJointMeans(const StepWeights& w) {
  const std::size_t count = plan.bodies.size();
  std::vector<Wrench> joints(count);
  const CoupledState& solved = scratch.other;
  for (std::size_t b = 0; b < count; ++b) {
    const RigidBody& body = plan.bodies[b];
    if (body.motion != BodyMotion::kFree && !body.joint) continue;
    const Vector6d change = solved.twists[b] - plan.free_twists[b];
    const double part = w.implicit / w.dt;
    joints[b].force = body.mass / w.dt * change.head<3>() - part * (solved.liquid[b].force + solved.contact[b].force);
    joints[b].torque =
        body.worldInertia() / w.dt * change.tail<3>() - part * (solved.liquid[b].torque + solved.contact[b].torque);
  }
  const JointDrives drives(state.bodies, commands, w, scratch.joint_modes);
  for (const StopForce& stop : solved.contact_forces.stops) {
    addJointEffort(plan.bodies, stop.body, -w.implicit / w.dt * stop.sign * stop.effort, joints);
  }
  const double share = w.dt / scene.time_step;
  for (std::size_t b = 0; b < count; ++b) {
    const double velocity = jointVelocity(plan.bodies, b, solved.twists);
    const double friction = drives.frictionEffort(b, velocity);
    if (friction != 0.0) addJointEffort(plan.bodies, b, -friction, joints);
    joints[b].force += w.carry * state.joints[b].force;
    joints[b].torque += w.carry * state.joints[b].torque;
    const double servo = drives.servoEffort(b, velocity);
    state.mean_effort[b] += share * (JointDrives::heldEffort(state.bodies[b], commands[b]) + servo);
  }
  // What is prescribed takes what holds the bodies along its axis, which has turned meanwhile.
  for (const std::vector<RigidBody>* at : {&state.bodies, &plan.bodies}) {
    const std::vector<double> along = effortsThrough(*at, joints);
    for (std::size_t b = 0; b < count; ++b) {
      const std::optional<JointDescription>& joint = plan.bodies[b].joint;
      if (joint && joint->prescribed) state.mean_effort[b] += 0.5 * share * along[b];
    }
  }
  state.joints = joints;
}

}  // namespace monolith
