#include "node/body_services.h"

#include <cstdio>
#include <limits>
#include <stdexcept>

#include "node/message_conversion.h"
#include "node/request_error.h"

namespace monolith {
namespace {

constexpr double kLongestWaitSec = 1e9;  // until a wrench begins

std::string shownSeconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", seconds);
  return text;
}

}  // namespace

BodyServices::BodyServices(ros::NodeHandle& local, TankControl& control, const std::string& world_frame, Hooks hooks)
    : control_(control), world_frame_(world_frame), hooks_(std::move(hooks)) {
  servers_.push_back(local.advertiseService("apply_body_wrench", &BodyServices::applyWrench, this));
  servers_.push_back(local.advertiseService("clear_body_wrenches", &BodyServices::clearWrenches, this));
  servers_.push_back(local.advertiseService("get_body_state", &BodyServices::getState, this));
  servers_.push_back(local.advertiseService("set_body_state", &BodyServices::setState, this));
  servers_.push_back(local.advertiseService("set_joint_state", &BodyServices::setJoints, this));
}

template <typename Response>
bool BodyServices::answer(const char* service, Response& response, const std::function<void()>& action) {
  response.success = false;
  try {
    action();
    response.success = true;
  } catch (const std::exception& error) {  // bad request, refused by the simulation, or a time that ROS cannot hold
    response.status_message = error.what();
  }
  if (!response.success) hooks_.refuse(std::string("~") + service + ": " + response.status_message);
  return true;
}

bool BodyServices::applyWrench(monolith_tank::ApplyBodyWrench::Request& request,
                               monolith_tank::ApplyBodyWrench::Response& response) {
  return answer("apply_body_wrench", response, [&] {
    const int body = control_.findBody(request.body_name, "body_name");
    control_.requireMovable(body, "body_name");
    control_.framePose(request.reference_frame, "reference_frame");  // refuses an unknown one by the field's name
    WrenchCommand command;
    command.frame = request.reference_frame;
    command.point = fromMessage(request.reference_point, "reference_point");
    command.force = fromMessage(request.wrench.force, "wrench.force");
    command.torque = fromMessage(request.wrench.torque, "wrench.torque");
    if (request.duration.isZero()) {
      throw RequestError("duration: value 0 s: expected > 0, or < 0 for a wrench without end");
    }
    // As numbers: ROS cannot hold every difference of two times.
    const double wait = request.start_time.toSec() - hooks_.now().toSec();
    if (wait > kLongestWaitSec) {
      throw RequestError("start_time: value " + shownSeconds(request.start_time.toSec()) + " s: expected at most " +
                         shownSeconds(kLongestWaitSec) + " s after now, " + shownSeconds(hooks_.now().toSec()) + " s");
    }
    command.start = control_.simulation().time() + std::max(wait, 0.0);
    command.end = request.duration < ros::Duration(0.0) ? std::numeric_limits<double>::infinity()
                                                        : command.start + request.duration.toSec();
    control_.requireFinite(WrenchCommands::Kind::kApplied, body, command);
    control_.wrenches().apply(body, command);
  });
}

bool BodyServices::clearWrenches(monolith_tank::ClearBodyWrenches::Request& request,
                                 monolith_tank::ClearBodyWrenches::Response& response) {
  return answer("clear_body_wrenches", response,
                [&] { control_.wrenches().clear(control_.findBody(request.body_name, "body_name")); });
}

bool BodyServices::getState(monolith_tank::GetBodyState::Request& request,
                            monolith_tank::GetBodyState::Response& response) {
  return answer("get_body_state", response, [&] {
    const int body = control_.findBody(request.body_name, "body_name");
    const Eigen::Isometry3d X_FW = control_.framePose(request.reference_frame, "reference_frame").inverse();
    const BodyState state = control_.simulation().bodyStates()[body];
    response.header.stamp = hooks_.now();
    response.header.frame_id = request.reference_frame.empty() ? world_frame_ : request.reference_frame;
    response.pose = toPose(X_FW * state.X_WB);
    response.twist = toTwist(X_FW.linear() * state.velocity, X_FW.linear() * state.angular_velocity);
  });
}

bool BodyServices::setState(monolith_tank::SetBodyState::Request& request,
                            monolith_tank::SetBodyState::Response& response) {
  return answer("set_body_state", response, [&] {
    const int body = control_.findBody(request.body_name, "body_name");
    control_.requireFree(body, "body_name");
    const Eigen::Isometry3d X_WF = control_.framePose(request.reference_frame, "reference_frame");
    const Eigen::Isometry3d X_WB = X_WF * fromMessage(request.pose, "pose");
    const Eigen::Vector3d velocity = X_WF.linear() * fromMessage(request.twist.linear, "twist.linear");
    const Eigen::Vector3d angular = X_WF.linear() * fromMessage(request.twist.angular, "twist.angular");
    control_.simulation().setBodyState(body, X_WB, velocity, angular);
    hooks_.state_changed();
  });
}

bool BodyServices::setJoints(monolith_tank::SetJointState::Request& request,
                             monolith_tank::SetJointState::Response& response) {
  return answer("set_joint_state", response, [&] {
    const Robot& robot = control_.findRobot(request.body, "body");
    const std::vector<int> bodies = findJoints(control_.simulation().scene(), robot, request.names, "names");
    requireNumbers(request.positions, request.names, "positions");
    if (request.velocities.empty()) {
      request.velocities.assign(request.names.size(), 0.0);
    } else {
      requireNumbers(request.velocities, request.names, "velocities");
    }
    control_.requireInRange(bodies, request.positions, "positions");
    std::vector<JointState> states;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      states.push_back({bodies[i], request.positions[i], request.velocities[i], 0.0});
    }
    control_.simulation().setJointStates(states);
    hooks_.state_changed();
  });
}

}  // namespace monolith
