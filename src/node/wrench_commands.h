#pragma once
// Wrenches that act on bodies for a while, in whatever frame they were given in.
//
// A command in frame F (pose X_WF) acts with force R_WF f at the point X_WF r and with torque R_WF t; on the centre of
// mass that is force R_WF f and torque R_WF t + (X_WF r - p_WBcm) x R_WF f. X_WF is taken anew each step, so a command
// in the frame of a body follows that body. Times are s on the node's clock.

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "node/frame_tree.h"
#include "rigid/rigid_body.h"
#include "simulation/simulation.h"

namespace monolith {

struct WrenchCommand {
  std::string frame;                                  // empty: world axes, point relative to the centre of mass
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    // N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();   // N m
  double start = 0.0;                                 // s
  double end = 0.0;                                   // s; infinity: until cleared
};

class WrenchCommands {
 public:
  WrenchCommands(std::size_t bodies, const FrameTree& frames) : frames_(frames), active_(bodies) {}

  // Why a command cannot be taken; empty if it can.
  std::string violation(const WrenchCommand& command, const std::vector<BodyState>& states) const;

  // Replaces what was held for the body before.
  void hold(int body, const WrenchCommand& command);
  // Acts besides everything else; for a step at least, unless end <= start.
  void add(int body, const WrenchCommand& command);
  void clear(int body);
  void clearAll();

  // Sum on each body for the step that starts at `time`; commands that have ended are dropped.
  std::vector<Wrench> take(double time, const std::vector<BodyState>& states, const std::vector<RigidBody>& bodies);

 private:
  struct Active {
    WrenchCommand command;
    bool held;
    bool has_acted = false;
    // Last known pose, for frames that vanish from tf while the command lasts.
    std::optional<Eigen::Isometry3d> X_WF;
  };
  bool hasEnded(const Active& active, double time) const;
  Wrench evaluate(Active& active, const std::vector<BodyState>& states, const RigidBody& body) const;

  const FrameTree& frames_;
  std::vector<std::vector<Active>> active_;
};

}  // namespace monolith
