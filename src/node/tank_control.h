#pragma once
// The simulation together with the wrenches that users put on it: what topics and services act on. Requests are
// checked here; whatever is wrong is a RequestError and changes nothing.

#include <tf2/buffer_core.h>

#include <string>
#include <vector>

#include "node/reference_frames.h"
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

  // Index of a body; RequestError with the nearest known name.
  int findBody(const std::string& name, const std::string& field) const;
  // RequestError unless wrenches and twists can move the body.
  void requireFree(int body, const std::string& field) const;
  // X_WF now. The empty frame is the world.
  Eigen::Isometry3d framePose(const std::string& frame, const std::string& field) const;

  // RequestError unless the wrench, about the body's centre of mass, and its sum with what acts beside it are finite.
  void requireFinite(WrenchCommands::Kind kind, int body, const WrenchCommand& command) const;

  // One output step with the wrenches as they are now. Messages of wrenches given up are appended to `lost`. A step
  // that throws is reported as one that was not committed. Wrenches of a step that was not committed are still to act.
  StepReport step(std::vector<std::string>& lost);
  void reset();

 private:
  WrenchCommands::FramePose framePoses() const;

  Simulation simulation_;
  ReferenceFrames frames_;
  WrenchCommands wrenches_;
};

}  // namespace monolith
