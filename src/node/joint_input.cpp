#include "node/joint_input.h"

#include "node/request_error.h"

namespace monolith {
namespace {

constexpr int kQueueSize = 10;

}  // namespace

JointInput::JointInput(ros::NodeHandle& local, TankControl& control, double timeout_sec, Refuse refuse)
    : control_(control), timeout_sec_(timeout_sec), refuse_(std::move(refuse)) {
  for (const Robot& robot : control.robots()) {
    const std::string topic = local.resolveName(robot.name + "/joint_commands");
    const boost::function<void(const sensor_msgs::JointState&)> callback =
        [this, &robot, topic](const sensor_msgs::JointState& message) { receive(message, robot, topic); };
    subscribers_.push_back(local.subscribe<sensor_msgs::JointState, const sensor_msgs::JointState&>(
        robot.name + "/joint_commands", kQueueSize, callback));
  }
}

void JointInput::receive(const sensor_msgs::JointState& message, const Robot& robot, const std::string& topic) {
  try {
    const std::vector<int> bodies = findJoints(control_.simulation().scene(), robot, message.name, "name");
    if (message.position.empty() && message.velocity.empty() && message.effort.empty()) {
      throw RequestError(
          "position, velocity, effort: no values: expected one of them, or more, with a value for each name");
    }
    if (!message.position.empty()) requireNumbers(message.position, message.name, "position");
    if (!message.velocity.empty()) requireNumbers(message.velocity, message.name, "velocity");
    if (!message.effort.empty()) requireNumbers(message.effort, message.name, "effort");
    const double end = control_.simulation().time() + timeout_sec_;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!message.position.empty()) control_.joints().holdPosition(bodies[i], message.position[i]);
      if (!message.velocity.empty()) control_.joints().holdVelocity(bodies[i], message.velocity[i], end);
      if (!message.effort.empty()) control_.joints().holdEffort(bodies[i], message.effort[i], end);
    }
  } catch (const RequestError& error) {
    refuse_(topic + ": " + error.what());
  }
}

}  // namespace monolith
