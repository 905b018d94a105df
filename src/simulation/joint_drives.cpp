#include "simulation/joint_drives.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigid/articulation.h"

namespace monolith {
namespace {

// A joint that sticks is as hard to move as if what hangs on it had this many times its inertia, and moves no faster
// than this (rad/s, m/s) before its friction is used up.
constexpr double kStick = 1e6;
constexpr double kCreep = 1e-6;

bool hasServo(const RigidBody& body) { return body.hasFreeJoint() && body.joint->servo.any(); }

}  // namespace

JointDrives::JointDrives(const std::vector<RigidBody>& bodies, const std::vector<JointCommand>& commands,
                         const StepWeights& w, std::vector<JointMode> modes)
    : bodies_(bodies), commands_(commands), weights_(w), modes_(std::move(modes)), inertia_(jointInertias(bodies)) {}

double JointDrives::heldEffort(const RigidBody& body, const JointCommand& command) {
  if (!body.hasFreeJoint()) return 0.0;
  return std::clamp(command.effort, -body.joint->most_effort, body.joint->most_effort);
}

bool JointDrives::any() const { return std::any_of(bodies_.begin(), bodies_.end(), hasServo) || limited(); }

bool JointDrives::limited() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const RigidBody& body) {
    if (!body.hasFreeJoint()) return false;
    return body.joint->friction > 0.0 || (hasServo(body) && std::isfinite(body.joint->most_effort));
  });
}

int JointDrives::mostRounds() const {
  return 8 + 2 * static_cast<int>(std::count_if(bodies_.begin(), bodies_.end(),
                                                [](const RigidBody& body) { return body.hasFreeJoint(); }));
}

double JointDrives::fastest(std::size_t b) const {
  const RigidBody& body = bodies_[b];
  double speed = std::abs(body.joint_velocity);
  if (!hasServo(body)) return speed;
  const Servo servo = servoOf(b);
  const double wanted = std::abs(servo.constant) / servo.slope;
  const double most = std::max(std::abs(servo.most), std::abs(servo.least));
  return std::max(speed, std::min(wanted, speed + weights_.dt * most / inertia_[b]));
}

JointDrives::Servo JointDrives::servoOf(std::size_t b) const {
  const RigidBody& body = bodies_[b];
  const JointServo& gains = body.joint->servo;
  const JointCommand& to = commands_[b];
  const double held = heldEffort(body, to);
  Servo servo;
  // The position by the new velocity alone: by the mean of both a stiff servo would make that alternate for ever. What
  // is different is of second order.
  servo.constant = gains.stiffness * (to.position - body.joint_position) + gains.damping * to.velocity;
  servo.slope = gains.damping + weights_.dt * gains.stiffness;
  servo.most = body.joint->most_effort - held;
  servo.least = -body.joint->most_effort - held;
  return servo;
}

double JointDrives::stickResistance(std::size_t b) const {
  return std::max(kStick * inertia_[b], weights_.dt * bodies_[b].joint->friction / kCreep);
}

double JointDrives::effort(std::size_t b) const {
  if (!bodies_[b].hasFreeJoint()) return 0.0;
  const Servo servo = servoOf(b);
  const JointMode mode = modes_[b];
  const double drives = mode.servo > 0 ? servo.most : mode.servo < 0 ? servo.least : servo.constant;
  return weights_.implicit / weights_.dt * drives - mode.friction * bodies_[b].joint->friction;
}

double JointDrives::resistance(std::size_t b) const {
  if (!bodies_[b].hasFreeJoint()) return 0.0;
  const JointMode mode = modes_[b];
  const double slope = mode.servo == 0 ? servoOf(b).slope : 0.0;
  const bool sticks = bodies_[b].joint->friction > 0.0 && mode.friction == 0;
  return weights_.implicit * (slope + bodies_[b].joint->damping) + (sticks ? stickResistance(b) : 0.0);
}

std::vector<double> JointDrives::resistances() const {
  std::vector<double> out;
  for (std::size_t b = 0; b < bodies_.size(); ++b) out.push_back(resistance(b));
  return out;
}

bool JointDrives::agree(const std::vector<double>& velocities) {
  bool right = true;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!bodies_[b].hasFreeJoint()) continue;
    const Servo servo = servoOf(b);
    const double asked = servo.constant - servo.slope * velocities[b];
    JointMode next;
    next.servo = asked > servo.most ? 1 : asked < servo.least ? -1 : 0;
    // From one limit to the other there is motion that asks for less than either.
    if (next.servo * modes_[b].servo < 0) next.servo = 0;
    next.friction = modes_[b].friction;
    if (bodies_[b].joint->friction > 0.0) {
      if (modes_[b].friction == 0) {
        const double needed = stickResistance(b) * velocities[b] / weights_.dt;
        if (std::abs(needed) > bodies_[b].joint->friction) next.friction = needed > 0.0 ? 1 : -1;
      } else if (velocities[b] * modes_[b].friction < 0.0) {
        next.friction = 0;
      }
    }
    right = right && next.servo == modes_[b].servo && next.friction == modes_[b].friction;
    modes_[b] = next;
  }
  return right;
}

double JointDrives::servoEffort(std::size_t b, double velocity) const {
  if (!bodies_[b].hasFreeJoint()) return 0.0;
  const Servo servo = servoOf(b);
  return std::clamp(servo.constant - servo.slope * velocity, servo.least, servo.most);
}

double JointDrives::frictionEffort(std::size_t b, double velocity) const {
  if (!bodies_[b].hasFreeJoint() || bodies_[b].joint->friction == 0.0) return 0.0;
  if (modes_[b].friction != 0) return -modes_[b].friction * bodies_[b].joint->friction;
  return -stickResistance(b) * velocity / weights_.dt;
}

}  // namespace monolith
