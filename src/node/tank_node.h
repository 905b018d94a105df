#pragma once
// The node: one thread that alternates between callbacks and steps, so that what callers see is always the state
// between two steps.
//
//   serve callbacks -> (paced: until the step is due) -> step -> publish
//
// A step that is not committed pauses the simulation with its state kept; unpausing, stepping or resetting tries again.

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <memory>

#include "monolith_tank/StepPhysics.h"
#include "node/body_services.h"
#include "node/foreign_frames.h"
#include "node/health_diagnostics.h"
#include "node/joint_input.h"
#include "node/node_options.h"
#include "node/pacing.h"
#include "node/progress_bar.h"
#include "node/state_publisher.h"
#include "node/tank_control.h"
#include "node/wrench_input.h"

namespace monolith {

class TankNode {
 public:
  // Throws SceneError. `queue` is the one that the callbacks of both handles arrive in.
  TankNode(ros::NodeHandle& global, ros::NodeHandle& local, ros::CallbackQueue& queue, const NodeOptions& options,
           const Scene& scene);

  // Until the duration is over or ROS shuts down. False if a bounded run ended because a step failed.
  [[nodiscard]] bool run();
  double time() const { return control_.simulation().time(); }  // s, simulated

 private:
  void waitForSubscribers();
  void linger();
  void serve(double wall_sec);
  bool isFinished() const;
  void stateChanged();
  // False if the step was not committed.
  bool advance();
  void setPaused(bool paused);
  void refuse(const std::string& message);
  void updateDiagnostics(bool force);

  bool pause(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool unpause(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool stepPhysics(monolith_tank::StepPhysics::Request& request, monolith_tank::StepPhysics::Response& response);

  NodeOptions options_;
  ros::CallbackQueue& queue_;
  tf2_ros::Buffer transforms_;
  TankControl control_;
  StatePublisher publisher_;
  HealthDiagnostics diagnostics_;
  tf2_ros::TransformListener listener_;
  ForeignFrames foreign_frames_;
  WrenchInput wrench_input_;
  JointInput joint_input_;
  BodyServices body_services_;
  std::vector<ros::ServiceServer> servers_;
  std::unique_ptr<ProgressBar> progress_;
  RealTimePacer pacer_;
  RealTimeFactor factor_;
  NodeHealth health_;
  double last_heartbeat_wall_sec_ = -1e9;
};

}  // namespace monolith
