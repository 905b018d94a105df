#include "node/reference_frames.h"

#include <tf2/exceptions.h>

#include <algorithm>

#include "node/message_conversion.h"
#include "node/request_error.h"
#include "node/robots.h"
#include "scene/nearest_word.h"

namespace monolith {
namespace {

constexpr int kMostAncestors = 1000;  // a loop in tf would never end

}  // namespace

ReferenceFrames::ReferenceFrames(const Scene& scene, const FrameNames& names, const tf2::BufferCore& transforms)
    : names_(names), transforms_(transforms) {
  own_[names.world] = {-1, Eigen::Isometry3d::Identity()};
  own_[names.tank()] = {-1, Eigen::Isometry3d(Eigen::Translation3d(scene.tank.origin))};
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyDescription& body = scene.bodies[b];
    const auto add = [&](const std::string& frame, const std::string& of, const Eigen::Isometry3d& X_BF) {
      if (own_.emplace(frame, OwnFrame{static_cast<int>(b), X_BF}).second) return;
      throw SceneError(scene.source + ": body \"" + body.name + "\": " + of + " has the tf frame \"" + frame +
                       "\": expected one of its own, ~world_frame is \"" + names.world + "\" and the tank's \"" +
                       names.tank() + "\"");
    };
    add(names.body(body.name), "the body", Eigen::Isometry3d::Identity());
    for (const NamedFrame& link : linkFrames(scene, static_cast<int>(b), names)) {
      add(link.frame, "link \"" + link.link + "\"", link.X_BL);
    }
  }
}

std::set<std::string> ReferenceFrames::movedFrames() const {
  std::set<std::string> frames;
  for (const auto& entry : own_) frames.insert(entry.first);
  frames.erase(names_.world);
  return frames;
}

Eigen::Isometry3d ReferenceFrames::poseOf(const OwnFrame& frame, const std::vector<RigidBody>& bodies) const {
  return frame.body < 0 ? frame.X_BF : bodies[frame.body].pose() * frame.X_BF;
}

std::string ReferenceFrames::ownAncestor(const std::string& frame) const {
  std::string ancestor = frame;
  for (int i = 0; i < kMostAncestors; ++i) {
    if (own_.count(ancestor)) return ancestor;
    std::string parent;
    if (!transforms_._frameExists(ancestor) || !transforms_._getParent(ancestor, ros::Time(0), parent)) return "";
    ancestor = parent;
  }
  return "";
}

Eigen::Isometry3d ReferenceFrames::pose(const std::string& frame, const std::vector<RigidBody>& bodies) const {
  const auto own = own_.find(frame);
  if (own != own_.end()) return poseOf(own->second, bodies);
  // A frame above the world, such as "map", has no ancestor of ours; tf knows it relative to the world all the same.
  const std::string ancestor = ownAncestor(frame);
  const std::string& target = ancestor.empty() ? names_.world : ancestor;
  try {
    const auto transform = transforms_.lookupTransform(target, frame, ros::Time(0));
    return poseOf(own_.at(target), bodies) * fromTransform(transform.transform);
  } catch (const tf2::TransformException&) {
    throwUnknown(frame);
  }
}

void ReferenceFrames::throwUnknown(const std::string& frame) const {
  std::vector<std::string> known;
  for (const auto& entry : own_) known.push_back(entry.first);
  std::vector<std::string> others;
  transforms_._getFrameStrings(others);
  std::sort(others.begin(), others.end());
  known.insert(known.end(), others.begin(), others.end());
  known.erase(std::remove(known.begin(), known.end(), frame), known.end());
  throw RequestError("frame \"" + frame + "\": expected a tf frame connected to \"" + names_.world +
                     "\", the nearest known is \"" + nearestWord(frame, known) + "\"");
}

}  // namespace monolith
