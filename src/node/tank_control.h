#pragma once
// The simulation together with the wrenches and joint commands that users give it: what topics and services act on.
// Requests are checked here; whatever is wrong is a RequestError and changes nothing.

#include <tf2/buffer_core.h>

#include <string>
#include <vector>

#include "node/joint_commands.h"
#include "node/reference_frames.h"
#include "node/robots.h"
#include "node/wrench_commands.h"
#include "simulation/simulation.h"

namespace monolith {

class TankControl {
 public:
  // Throws SceneError.
  TankControl(const Scene& scene, const FrameNames& names, const tf2::BufferCore& transforms);

  Simulation& simulation() { return simulation_; }
  const Simulation& simulation() const { return simulation_; }
  const ReferenceFrames& frames() const { return frames_; }
  WrenchCommands& wrenches() { return wrenches_; }
  JointCommands& joints() { return joints_; }
  const std::vector<Robot>& robots() const { return robots_; }

  // Index of a body; RequestError with the nearest known name.
  int findBody(const std::string& name, const std::string& field) const;
  // RequestError with the nearest known name.
  const Robot& findRobot(const std::string& name, const std::string& field) const;
  // RequestError unless the scene lets the body go where it is put. What hangs on another is the simulation's to
  // refuse.
  void requireFree(int body, const std::string& field) const;
  // RequestError unless wrenches can move the body.
  void requireMovable(int body, const std::string& field) const;
  // X_WF now. The empty frame is the world.
  Eigen::Isometry3d framePose(const std::string& frame, const std::string& field) const;

  // RequestError unless the wrench, about the body's centre of mass, and its sum with what acts beside it are finite.
  void requireFinite(WrenchCommands::Kind kind, int body, const WrenchCommand& command) const;

  // RequestError unless the positions are within the limits of the joints, given by the bodies beyond them.
  void requireInRange(const std::vector<int>& bodies, const std::vector<double>& positions,
                      const std::string& field) const;

  // One output step with wrenches and joint commands as they are now. Messages of wrenches given up are appended to
  // `lost`. A step that throws is reported as one that was not committed. What was to act in a step that was not
  // committed is still to act.
  StepReport step(std::vector<std::string>& lost);
  void reset();

 private:
  WrenchCommands::FramePose framePoses() const;

  Simulation simulation_;
  ReferenceFrames frames_;
  WrenchCommands wrenches_;
  JointCommands joints_;
  std::vector<Robot> robots_;
};

}  // namespace monolith
