#include "node/wrench_commands.h"

#include <algorithm>

#include "node/message_conversion.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kTimeSlack = 1e-7;  // s, below which two instants are the same

}  // namespace

std::string WrenchCommands::violation(const WrenchCommand& command, const std::vector<BodyState>& states) const {
  if (!command.force.allFinite()) return "force " + shown(command.force) + ": expected finite numbers";
  if (!command.torque.allFinite()) return "torque " + shown(command.torque) + ": expected finite numbers";
  if (!command.point.allFinite()) return "point " + shown(command.point) + ": expected finite numbers";
  if (!command.frame.empty() && !frames_.pose(command.frame, states)) return frames_.describeUnknown(command.frame);
  return "";
}

void WrenchCommands::hold(int body, const WrenchCommand& command) {
  auto& list = active_[body];
  list.erase(std::remove_if(list.begin(), list.end(), [](const Active& a) { return a.held; }), list.end());
  list.push_back({command, true, false, std::nullopt});
}

void WrenchCommands::add(int body, const WrenchCommand& command) {
  if (command.end > command.start) active_[body].push_back({command, false, false, std::nullopt});
}

void WrenchCommands::clear(int body) { active_[body].clear(); }

void WrenchCommands::clearAll() {
  for (auto& list : active_) list.clear();
}

bool WrenchCommands::hasEnded(const Active& active, double time) const {
  return time >= active.command.end - kTimeSlack && active.has_acted;
}

Wrench WrenchCommands::evaluate(Active& active, const std::vector<BodyState>& states, const RigidBody& body) const {
  const WrenchCommand& command = active.command;
  if (command.frame.empty()) return {command.force, command.torque + command.point.cross(command.force)};
  if (const auto pose = frames_.pose(command.frame, states)) active.X_WF = pose;
  if (!active.X_WF) return {};
  const Isometry3d& X_WF = *active.X_WF;
  const Vector3d force = X_WF.linear() * command.force;
  return {force, X_WF.linear() * command.torque + (X_WF * command.point - body.p_WBcm).cross(force)};
}

std::vector<Wrench> WrenchCommands::take(double time, const std::vector<BodyState>& states,
                                         const std::vector<RigidBody>& bodies) {
  std::vector<Wrench> sums(active_.size());
  for (std::size_t b = 0; b < active_.size(); ++b) {
    auto& list = active_[b];
    list.erase(std::remove_if(list.begin(), list.end(), [&](const Active& a) { return hasEnded(a, time); }), list.end());
    for (Active& active : list) {
      if (active.command.start > time + kTimeSlack) continue;
      const Wrench wrench = evaluate(active, states, bodies[b]);
      active.has_acted = true;
      sums[b].force += wrench.force;
      sums[b].torque += wrench.torque;
    }
  }
  return sums;
}

}  // namespace monolith
