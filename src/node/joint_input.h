#pragma once
// ~<robot>/joint_commands of every robot: by the joints' names any of positions, velocities and efforts. What is given
// takes the place of what was; velocities and efforts are held for ~wrench_timeout of simulated time. The stamp is not
// looked at.

#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <functional>
#include <string>
#include <vector>

#include "node/tank_control.h"

namespace monolith {

class JointInput {
 public:
  using Refuse = std::function<void(const std::string& message)>;

  JointInput(ros::NodeHandle& local, TankControl& control, double timeout_sec, Refuse refuse);

 private:
  void receive(const sensor_msgs::JointState& message, const Robot& robot, const std::string& topic);

  TankControl& control_;
  double timeout_sec_;
  Refuse refuse_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace monolith
