#pragma once
// Poses of tf frames in the world at the moment of the simulation's state. The node's own frames - the world, the
// tank's corner, each body and each of its links (frame_names.h) - come from the state itself. Any other frame is
// followed through tf to the nearest of those, so that a frame fixed to a body is exactly where the body is.

#include <tf2/buffer_core.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "node/frame_names.h"
#include "rigid/rigid_body.h"
#include "scene/scene.h"

namespace monolith {

class ReferenceFrames {
 public:
  // Throws SceneError if one of its own frames has the name of another, such as the world's. `transforms` must outlive
  // this.
  ReferenceFrames(const Scene& scene, const FrameNames& names, const tf2::BufferCore& transforms);

  // X_WF. Throws RequestError if the frame is not connected to the world, naming the nearest known frame.
  Eigen::Isometry3d pose(const std::string& frame, const std::vector<RigidBody>& bodies) const;

  const std::string& worldFrame() const { return names_.world; }
  // The node's own but for the world's.
  std::set<std::string> movedFrames() const;

 private:
  struct OwnFrame {
    int body;  // -1: the world
    Eigen::Isometry3d X_BF;
  };

  Eigen::Isometry3d poseOf(const OwnFrame& frame, const std::vector<RigidBody>& bodies) const;
  // The frame itself or the first of its ancestors in tf that is ours; empty if there is none.
  std::string ownAncestor(const std::string& frame) const;
  [[noreturn]] void throwUnknown(const std::string& frame) const;

  FrameNames names_;
  std::map<std::string, OwnFrame> own_;
  const tf2::BufferCore& transforms_;
};

}  // namespace monolith
