#include "node/foreign_frames.h"

#include <utility>

namespace monolith {
namespace {

constexpr int kQueueSize = 100;

}  // namespace

ForeignFrames::ForeignFrames(ros::NodeHandle& global, std::set<std::string> own) : own_(std::move(own)) {
  tf_ = global.subscribe("/tf", kQueueSize, &ForeignFrames::receive, this);
  tf_static_ = global.subscribe("/tf_static", kQueueSize, &ForeignFrames::receive, this);
}

void ForeignFrames::receive(const ros::MessageEvent<const tf2_msgs::TFMessage>& event) {
  const std::string& node = event.getPublisherName();
  if (node == ros::this_node::getName()) return;
  std::string frames;
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    const std::string& frame = transform.child_frame_id;
    if (!own_.count(frame) || !told_.emplace(node, frame).second) continue;
    frames += (frames.empty() ? "\"" : ", \"") + frame + "\"";
  }
  if (frames.empty()) return;
  ROS_WARN(
      "%s publishes tf frames of this node too: %s; with two of them each jumps to and fro: give this node's a "
      "~frame_prefix of their own",
      node.c_str(), frames.c_str());
}

}  // namespace monolith
