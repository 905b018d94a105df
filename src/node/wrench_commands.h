#pragma once
// Wrenches that users apply to bodies: one held per body from its topic, any number from the service. All of them are
// summed anew before each step, in the frame where they were given as it then is: a wrench in a frame fixed to the
// body turns with the body.
//
// A command in frame F acts with force R_WF f at the point X_WF r and with torque R_WF t: on the centre of mass that
// is force R_WF f and torque R_WF t + (X_WF r - p_WBcm) x R_WF f.

#include <functional>
#include <string>
#include <vector>

#include "rigid/integration.h"
#include "rigid/rigid_body.h"

namespace monolith {

struct WrenchCommand {
  std::string frame;                                 // tf frame F; empty: the world
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // r, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // f, N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // t, N m
  double start = 0.0;                                // s, simulated
  double end = 0.0;                                  // s; acts in at least one step
};

Wrench aboutCentreOfMass(const WrenchCommand& command, const Eigen::Isometry3d& X_WF, const Eigen::Vector3d& p_WBcm);

class WrenchCommands {
 public:
  // X_WF of a frame; throws RequestError.
  using FramePose = std::function<Eigen::Isometry3d(const std::string& frame)>;

  // time_step: s, of the steps that commands begin and end with.
  WrenchCommands(int bodies, double time_step);

  enum class Kind { kHeld, kApplied };
  // RequestError if the command would be given up when it begins, in frames as they are now: alone, or with what acts
  // beside it then.
  void requireFinite(Kind kind, int body, const WrenchCommand& command, const RigidBody& on,
                     const FramePose& frame_pose) const;
  // In place of what is held for the body.
  void hold(int body, const WrenchCommand& command);
  // Beside what acts on the body already.
  void apply(int body, const WrenchCommand& command);
  void clear(int body);
  void clear();

  // The sum for each body in the step that begins at `time`, always finite. Commands that are over are forgotten. So
  // are those whose frame is no longer known, or that with those before them are too large for a number: a line for
  // each is appended to `lost`.
  std::vector<Wrench> evaluate(double time, const std::vector<RigidBody>& bodies, const FramePose& frame_pose,
                               std::vector<std::string>& lost);
  // The step that was evaluated last was committed: only now have its commands acted.
  void commit();

 private:
  struct Entry {
    WrenchCommand command;
    bool acts = false;  // in the step that was evaluated last
    bool has_acted = false;
  };
  void evaluate(std::vector<Entry>& entries, double time, const RigidBody& body, const FramePose& frame_pose,
                Wrench& sum, std::vector<std::string>& lost) const;

  double slack_;  // s: by so much a command's times may miss the beginning of a step that they mean
  std::vector<std::vector<Entry>> held_;  // at most one each
  std::vector<std::vector<Entry>> applied_;
};

}  // namespace monolith
