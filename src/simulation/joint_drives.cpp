#include "simulation/joint_drives.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigid/articulation.h"

namespace monolith {
namespace {

// A joint that sticks is as hard to move as if the body beyond it had this many times its inertia.
constexpr double kStick = 1e6;

bool moves(const RigidBody& body) { return body.joint && !body.joint->prescribed; }

}  // namespace

JointDrives::JointDrives(const std::vector<RigidBody>& bodies, const std::vector<JointCommand>& commands,
                         const StepWeights& w, std::vector<JointMode> modes)
    : bodies_(bodies), commands_(commands), weights_(w), modes_(std::move(modes)) {}

double JointDrives::heldEffort(const RigidBody& body, const JointCommand& command) {
  if (!moves(body)) return 0.0;
  return std::clamp(command.effort, -body.joint->most_effort, body.joint->most_effort);
}

bool JointDrives::any() const { return std::any_of(bodies_.begin(), bodies_.end(), moves); }

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
  const RigidBody& body = bodies_[b];
  const Vector6d s = jointTwist(body);
  const Eigen::Vector3d axis = s.tail<3>();
  return kStick * (body.mass * s.head<3>().squaredNorm() + axis.dot(body.worldInertia() * axis));
}

double JointDrives::effort(std::size_t b) const {
  if (!moves(bodies_[b])) return 0.0;
  const Servo servo = servoOf(b);
  const JointMode mode = modes_[b];
  const double drives = mode.servo > 0 ? servo.most : mode.servo < 0 ? servo.least : servo.constant;
  return weights_.implicit / weights_.dt * drives - mode.friction * bodies_[b].joint->friction;
}

double JointDrives::resistance(std::size_t b) const {
  if (!moves(bodies_[b])) return 0.0;
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
    if (!moves(bodies_[b])) continue;
    const Servo servo = servoOf(b);
    const double asked = servo.constant - servo.slope * velocities[b];
    JointMode next;
    next.servo = asked > servo.most ? 1 : asked < servo.least ? -1 : 0;
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
  if (!moves(bodies_[b])) return 0.0;
  const Servo servo = servoOf(b);
  return std::clamp(servo.constant - servo.slope * velocity, servo.least, servo.most);
}

double JointDrives::frictionEffort(std::size_t b, double velocity) const {
  if (!moves(bodies_[b]) || bodies_[b].joint->friction == 0.0) return 0.0;
  if (modes_[b].friction != 0) return -modes_[b].friction * bodies_[b].joint->friction;
  return -stickResistance(b) * velocity / weights_.dt;
}

}  // namespace monolith
