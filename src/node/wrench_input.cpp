#include "node/wrench_input.h"

#include "node/message_conversion.h"
#include "node/request_error.h"
#include "node/robots.h"

namespace monolith {
namespace {

constexpr int kQueueSize = 10;

}  // namespace

WrenchInput::WrenchInput(ros::NodeHandle& local, TankControl& control, double timeout_sec, Refuse refuse)
    : control_(control), timeout_sec_(timeout_sec), refuse_(std::move(refuse)) {
  const std::vector<BodyDescription>& bodies = control.simulation().scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    if (!canBeMoved(control.simulation().scene(), body)) continue;
    const std::string topic = local.resolveName(bodies[b].name + "/wrench");
    const boost::function<void(const geometry_msgs::WrenchStamped&)> callback =
        [this, body, topic](const geometry_msgs::WrenchStamped& message) { receive(message, body, topic); };
    subscribers_.push_back(local.subscribe<geometry_msgs::WrenchStamped, const geometry_msgs::WrenchStamped&>(
        bodies[b].name + "/wrench", kQueueSize, callback));
  }
}

void WrenchInput::receive(const geometry_msgs::WrenchStamped& message, int body, const std::string& topic) {
  try {
    if (message.header.frame_id.empty()) {
      throw RequestError("header.frame_id: value \"\": expected a tf frame, such as the world's or the body's");
    }
    WrenchCommand command;
    command.frame = message.header.frame_id;
    command.force = fromMessage(message.wrench.force, "wrench.force");
    command.torque = fromMessage(message.wrench.torque, "wrench.torque");
    command.start = control_.simulation().time();
    command.end = command.start + timeout_sec_;
    // Refused now rather than in the step.
    control_.framePose(command.frame, "header.frame_id");
    control_.requireFinite(WrenchCommands::Kind::kHeld, body, command);
    control_.wrenches().hold(body, command);
  } catch (const RequestError& error) {
    refuse_(topic + ": " + error.what());
  }
}

}  // namespace monolith
