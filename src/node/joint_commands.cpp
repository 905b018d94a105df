#include "node/joint_commands.h"

#include "node/command_slack.h"

namespace monolith {

JointCommands::JointCommands(const Scene& scene) : slack_(commandSlack(scene.time_step)) {
  for (const BodyDescription& body : scene.bodies) {
    initial_positions_.push_back(body.joint ? body.joint->position : 0.0);
  }
  clear();
}

void JointCommands::clear() {
  held_.assign(initial_positions_.size(), Held());
  for (std::size_t b = 0; b < held_.size(); ++b) held_[b].position = initial_positions_[b];
}

std::vector<JointCommand> JointCommands::evaluate(double time) {
  std::vector<JointCommand> commands;
  for (Held& held : held_) {
    commands.push_back({evaluate(held.effort, time), held.position, evaluate(held.velocity, time)});
  }
  return commands;
}

double JointCommands::evaluate(Timed& timed, double time) const {
  if (timed.has_acted && time > timed.end - slack_) timed = Timed();
  return timed.value;
}

void JointCommands::commit() {
  for (Held& held : held_) {
    held.velocity.has_acted = true;
    held.effort.has_acted = true;
  }
}

}  // namespace monolith
