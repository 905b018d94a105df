#include "node/wrench_commands.h"

#include "node/command_slack.h"
#include "node/request_error.h"
#include "scene/shown_vector.h"

namespace monolith {
namespace {

bool isFinite(const Wrench& wrench) { return wrench.force.allFinite() && wrench.torque.allFinite(); }

std::string shown(const Wrench& wrench) {
  return "force " + shownVector(wrench.force) + " N and torque " + shownVector(wrench.torque) + " N m";
}

// RequestError if the wrench or the sum is too large for a number.
void add(const Wrench& wrench, Wrench& sum) {
  const std::string text = "about the centre of mass " + shown(wrench);
  if (!isFinite(wrench)) throw RequestError(text + ": expected finite numbers");
  const Wrench both{sum.force + wrench.force, sum.torque + wrench.torque};
  if (!isFinite(both)) throw RequestError(text + ", beside " + shown(sum) + " of others: expected a finite sum");
  sum = both;
}

}  // namespace

WrenchCommands::WrenchCommands(int bodies, double time_step)
    : slack_(commandSlack(time_step)), held_(bodies), applied_(bodies) {}

Wrench aboutCentreOfMass(const WrenchCommand& command, const Eigen::Isometry3d& X_WF, const Eigen::Vector3d& p_WBcm) {
  Wrench wrench;
  wrench.force = X_WF.linear() * command.force;
  wrench.torque = X_WF.linear() * command.torque + (X_WF * command.point - p_WBcm).cross(wrench.force);
  return wrench;
}

void WrenchCommands::requireFinite(Kind kind, int body, const WrenchCommand& command, const RigidBody& on,
                                   const FramePose& frame_pose) const {
  std::vector<Entry> others = applied_[body];
  if (kind == Kind::kApplied) others.insert(others.end(), held_[body].begin(), held_[body].end());
  Wrench sum;
  std::vector<std::string> lost;
  evaluate(others, command.start, on, frame_pose, sum, lost);
  add(aboutCentreOfMass(command, frame_pose(command.frame), on.p_WBcm), sum);
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
                              const FramePose& frame_pose, Wrench& sum, std::vector<std::string>& lost) const {
  std::vector<Entry> kept;
  for (Entry& entry : entries) {
    entry.acts = false;
    const bool over = entry.has_acted && time > entry.command.end - slack_;
    if (over) continue;
    if (time >= entry.command.start - slack_) {
      try {
        add(aboutCentreOfMass(entry.command, frame_pose(entry.command.frame), body.p_WBcm), sum);
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
