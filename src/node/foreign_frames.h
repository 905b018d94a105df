#pragma once
// Who else publishes this node's frames: with two of them on one tf a frame jumps to and fro for everybody.

#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <set>
#include <string>
#include <utility>

namespace monolith {

class ForeignFrames {
 public:
  // Warns of other nodes that give frames among `own` a parent, once of each frame of each.
  ForeignFrames(ros::NodeHandle& global, std::set<std::string> own);

 private:
  void receive(const ros::MessageEvent<const tf2_msgs::TFMessage>& event);

  std::set<std::string> own_;
  std::set<std::pair<std::string, std::string>> told_;  // node, frame
  ros::Subscriber tf_, tf_static_;
};

}  // namespace monolith
