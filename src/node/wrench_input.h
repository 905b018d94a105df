#pragma once
// ~<body>/wrench of every body that can be moved: a wrench in any tf frame, whose force acts at that frame's origin,
// held for ~wrench_timeout of simulated time. A later one replaces it. The stamp is not looked at.

#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

#include "node/tank_control.h"

namespace monolith {

class WrenchInput {
 public:
  using Refuse = std::function<void(const std::string& message)>;

  WrenchInput(ros::NodeHandle& local, TankControl& control, double timeout_sec, Refuse refuse);

 private:
  void receive(const geometry_msgs::WrenchStamped& message, int body, const std::string& topic);

  TankControl& control_;
  double timeout_sec_;
  Refuse refuse_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace monolith
