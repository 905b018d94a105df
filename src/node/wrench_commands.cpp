#include "node/wrench_commands.h"

#include "node/request_error.h"
#include "scene/shown_vector.h"

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

void requireFinite(const Wrench& wrench) {
  if (wrench.force.allFinite() && wrench.torque.allFinite()) return;
  throw RequestError("about the centre of mass force " + shownVector(wrench.force) + " N and torque " +
                     shownVector(wrench.torque) + " N m: expected finite numbers");
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

void WrenchCommands::commit() {
  for (auto* commands : {&held_, &applied_}) {
    for (std::vector<Entry>& entries : *commands) {
      for (Entry& entry : entries) entry.has_acted |= entry.acts;
    }
  }
}

void WrenchCommands::evaluate(std::vector<Entry>& entries, double time, const RigidBody& body,
                              const FramePose& frame_pose, Wrench& sum, std::vector<std::string>& lost) {
  std::vector<Entry> kept;
  for (Entry& entry : entries) {
    entry.acts = false;
    const bool over = entry.has_acted && time > entry.command.end - kTimeSlack;
    if (over) continue;
    if (time >= entry.command.start - kTimeSlack) {
      try {
        Wrench wrench = aboutCentreOfMass(entry.command, frame_pose(entry.command.frame), body.p_WBcm);
        wrench.force += sum.force;
        wrench.torque += sum.torque;
        requireFinite(wrench);
        sum = wrench;
        entry.acts = true;
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
