#include "node/wrench_commands.h"

#include "node/request_error.h"

namespace monolith {
namespace {

constexpr double kTimeSlack = 1e-6;  // s, round-off of a sum of steps

}  // namespace

Wrench aboutCentreOfMass(const WrenchCommand& command, const Eigen::Isometry3d& X_WF, const Eigen::Vector3d& p_WBcm) {
  Wrench wrench;
  wrench.force = X_WF.linear() * command.force;
  wrench.torque = X_WF.linear() * command.torque + (X_WF * command.point - p_WBcm).cross(wrench.force);
  return wrench;
}

void WrenchCommands::hold(int body, const WrenchCommand& command) { held_[body].assign(1, Entry{command}); }

void WrenchCommands::apply(int body, const WrenchCommand& command) { applied_[body].push_back(Entry{command}); }

void WrenchCommands::clear(int body) {
  held_[body].clear();
  applied_[body].clear();
}

void WrenchCommands::clear() {
  for (std::size_t b = 0; b < held_.size(); ++b) clear(static_cast<int>(b));
}

std::vector<Wrench> WrenchCommands::evaluate(double time, const std::vector<RigidBody>& bodies,
                                             const FramePose& frame_pose, std::vector<std::string>& lost) {
  std::vector<Wrench> sums(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    evaluate(held_[b], time, bodies[b], frame_pose, sums[b], lost);
    evaluate(applied_[b], time, bodies[b], frame_pose, sums[b], lost);
  }
  return sums;
}

void WrenchCommands::evaluate(std::vector<Entry>& entries, double time, const RigidBody& body,
                              const FramePose& frame_pose, Wrench& sum, std::vector<std::string>& lost) {
  std::vector<Entry> kept;
  for (Entry& entry : entries) {
    const bool over = entry.has_acted && time > entry.command.end - kTimeSlack;
    if (over) continue;
    if (time >= entry.command.start - kTimeSlack) {
      try {
        const Wrench wrench = aboutCentreOfMass(entry.command, frame_pose(entry.command.frame), body.p_WBcm);
        sum.force += wrench.force;
        sum.torque += wrench.torque;
        entry.has_acted = true;
      } catch (const RequestError& error) {
        lost.push_back("wrench on \"" + body.name + "\" given up: " + error.what());
        continue;
      }
    }
    kept.push_back(entry);
  }
  entries.swap(kept);
}

}  // namespace monolith
