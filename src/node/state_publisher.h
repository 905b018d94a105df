#pragma once
// Everything that the node publishes about the simulation but diagnostics. Message headers carry simulated time.
//
// /clock (with use_sim_time), /tf, /tf_static; in the private namespace body_states, BODY/odom, surface, statistics,
// markers; as parameters BODY/robot_description.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "node/node_options.h"
#include "node/rate_gate.h"
#include "node/simulation_runner.h"

namespace monolith {

class StatePublisher {
 public:
  StatePublisher(ros::NodeHandle node, ros::NodeHandle private_node, const NodeOptions& options,
                 const SimulationRunner& runner);

  // The clock always; the rest as its rate says. `report` false: the instant is not the end of a step.
  void publish(bool report, double real_time_factor);
  // Of a step that was not committed, whatever the rate.
  void publishStatistics(double real_time_factor);

  // Someone listens to each topic of the bodies, surface and statistics.
  bool hasSubscribers() const;

 private:
  std_msgs::Header header() const;
  void publishStates();

  const SimulationRunner& runner_;
  bool owns_clock_;
  RateGate state_gate_, surface_gate_, statistics_gate_, marker_gate_;
  ros::Publisher clock_, body_states_, surface_, statistics_, markers_;
  std::vector<ros::Publisher> odometry_;
  tf2_ros::TransformBroadcaster transforms_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
};

}  // namespace monolith
