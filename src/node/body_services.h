#pragma once
// Services on single bodies and their joints, named and shaped after Gazebo's: ~apply_body_wrench,
// ~clear_body_wrenches, ~get_body_state, ~set_body_state, ~set_joint_state. A request that cannot be done is answered
// with success = false and why.

#include <monolith_tank/ApplyBodyWrench.h>
#include <monolith_tank/ClearBodyWrenches.h>
#include <monolith_tank/GetBodyState.h>
#include <monolith_tank/SetBodyState.h>
#include <monolith_tank/SetJointState.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

#include "node/tank_control.h"

namespace monolith {

class BodyServices {
 public:
  struct Hooks {
    std::function<ros::Time()> now;  // stamp of the present state
    std::function<void(const std::string& message)> refuse;
    std::function<void()> state_changed;
  };

  BodyServices(ros::NodeHandle& local, TankControl& control, const std::string& world_frame, Hooks hooks);

  // Serves no longer.
  void close() { servers_.clear(); }

 private:
  bool applyWrench(monolith_tank::ApplyBodyWrench::Request& request,
                   monolith_tank::ApplyBodyWrench::Response& response);
  bool clearWrenches(monolith_tank::ClearBodyWrenches::Request& request,
                     monolith_tank::ClearBodyWrenches::Response& response);
  bool getState(monolith_tank::GetBodyState::Request& request, monolith_tank::GetBodyState::Response& response);
  bool setState(monolith_tank::SetBodyState::Request& request, monolith_tank::SetBodyState::Response& response);
  bool setJoints(monolith_tank::SetJointState::Request& request, monolith_tank::SetJointState::Response& response);

  // Runs the action and turns what it throws into the response.
  template <typename Response>
  bool answer(const char* service, Response& response, const std::function<void()>& action);

  TankControl& control_;
  std::string world_frame_;
  Hooks hooks_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace monolith
