#include "node/frame_tree.h"

#include "node/message_conversion.h"
#include "scene/yaml_map.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

}  // namespace

FrameTree::FrameTree(const Scene& scene, const std::string& world_frame, const tf2_ros::Buffer* buffer)
    : world_frame_(world_frame), buffer_(buffer) {
  own_[world_frame] = {-1, Isometry3d::Identity()};
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyDescription& body = scene.bodies[b];
    if (!own_.emplace(body.name, OwnFrame{static_cast<int>(b), Isometry3d::Identity()}).second) {
      throw SceneError(scene.source + ": body \"" + body.name + "\": expected a name other than the world frame's");
    }
    for (const LinkFrame& link : body.links) {
      own_[body.name + "/" + link.name] = {static_cast<int>(b), link.X_BL};
    }
  }
}

Isometry3d FrameTree::ownPose(const OwnFrame& own, const std::vector<BodyState>& states) const {
  return own.body < 0 ? own.X_BF : states[own.body].X_WB * own.X_BF;
}

std::optional<Isometry3d> FrameTree::pose(const std::string& frame, const std::vector<BodyState>& states) const {
  const auto own = own_.find(withoutSlash(frame));
  if (own != own_.end()) return ownPose(own->second, states);
  return buffer_ ? foreignPose(withoutSlash(frame), states) : std::nullopt;
}

std::optional<Isometry3d> FrameTree::foreignPose(const std::string& frame,
                                                 const std::vector<BodyState>& states) const {
  const ros::Time latest(0);
  if (frame.empty() || !buffer_->_frameExists(frame)) return std::nullopt;
  // Up to the first frame of ours; one that does not lead there may still reach the world from above.
  std::string base = frame;
  std::string parent;
  while (own_.find(base) == own_.end() && buffer_->_getParent(base, latest, parent)) base = parent;
  const auto own = own_.find(base);
  const bool above = own == own_.end();
  try {
    const std::string& target = above ? world_frame_ : base;
    const Isometry3d X_TF = toIsometry(buffer_->lookupTransform(target, frame, latest).transform);
    return above ? X_TF : ownPose(own->second, states) * X_TF;
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

std::string FrameTree::describeUnknown(const std::string& frame) const {
  std::vector<std::string> names;
  for (const auto& entry : own_) names.push_back(entry.first);
  if (frame.empty()) return "frame \"\" is empty: expected \"" + world_frame_ + "\", a body, BODY/LINK or a tf frame";
  return "frame \"" + frame + "\" is unknown: expected \"" + world_frame_ +
         "\", a body, BODY/LINK or a tf frame; nearest of ours is \"" + nearestWord(frame, names) + "\"";
}

}  // namespace monolith
