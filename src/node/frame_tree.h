#pragma once
// Poses of tf frames in the world frame W at the bodies' present state: the world frame, bodies ("ball"), links
// ("ball/tip", the root link's too) and, by a tf buffer, any frame that others publish.
//
// A foreign frame that hangs on a body or link, however indirectly, follows the simulated body exactly, not the last pose
// that went over tf.

#include <tf2_ros/buffer.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "simulation/simulation.h"

namespace monolith {

class FrameTree {
 public:
  // `buffer` may be null (no foreign frames) and must live as long as this. Throws SceneError if a body has the
  // world frame's name.
  FrameTree(const Scene& scene, const std::string& world_frame, const tf2_ros::Buffer* buffer);

  const std::string& worldFrame() const { return world_frame_; }
  // X_WF; nothing if the frame is unknown.
  std::optional<Eigen::Isometry3d> pose(const std::string& frame, const std::vector<BodyState>& states) const;
  // "frame "bal" is unknown: ...", with the nearest known name.
  std::string describeUnknown(const std::string& frame) const;

 private:
  struct OwnFrame {
    int body;  // -1: the world
    Eigen::Isometry3d X_BF;
  };
  std::optional<Eigen::Isometry3d> foreignPose(const std::string& frame, const std::vector<BodyState>& states) const;
  Eigen::Isometry3d ownPose(const OwnFrame& own, const std::vector<BodyState>& states) const;

  std::string world_frame_;
  std::map<std::string, OwnFrame> own_;
  const tf2_ros::Buffer* buffer_;
};

}  // namespace monolith
