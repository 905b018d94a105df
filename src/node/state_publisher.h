#pragma once
// Everything that the node tells about the simulation: /clock, tf, states, surface, statistics, markers, and the
// bodies' URDF texts as parameters. Each topic at its own rate of simulated time.
//
// Stamps are the simulated time plus one time step: ROS takes time 0 for "no time yet", so the initial state has the
// stamp of the first step.

#include <ros/ros.h>

#include <string>
#include <vector>

#include "node/body_markers.h"
#include "node/node_options.h"
#include "node/publish_gate.h"
#include "node/robots.h"
#include "simulation/simulation.h"

namespace monolith {

class StatePublisher {
 public:
  StatePublisher(ros::NodeHandle& global, ros::NodeHandle& local, const NodeOptions& options,
                 const Simulation& simulation);

  // What never changes: tank, link frames, URDF texts.
  void publishConstant();
  // The state that there is: what is due by its rate, what has not been published of this step yet, or all.
  enum class What { kDue, kMissing, kAll };
  void publish(const StepReport& report, double real_time_factor, What what);
  void publishStatistics(const StepReport& report, double real_time_factor);
  void publishClock();
  // This process's own ros::Time, where the node owns the clock: /clock comes back to it late.
  void setRosTime() const;

  // Throws std::runtime_error beyond the end of ROS time.
  ros::Time stamp() const;
  // Topics of the run's states that nobody listens to yet.
  std::vector<std::string> topicsWithoutSubscriber() const;

 private:
  void publishTransforms(const std::vector<BodyState>& states);
  void publishStates(const std::vector<BodyState>& states);
  void publishOdometry(const std::vector<BodyState>& states);
  void publishJoints();
  void publishMarkers(const std::vector<BodyState>& states);
  void publishSurface();
  std_msgs::Header header() const;

  ros::NodeHandle local_;
  const Simulation& simulation_;
  FrameNames frames_;
  bool owns_clock_;
  // When a topic, or several at once, is published, and the step of which it last was.
  struct Rhythm {
    PublishGate gate;
    long last_step = -1;
  };
  Rhythm state_rhythm_, surface_rhythm_, statistics_rhythm_, marker_rhythm_;
  double publishing_sec_ = 0.0;  // wall time, since the last statistics
  ros::Publisher clock_, tf_, tf_static_, states_, surface_, statistics_, markers_, tank_;
  std::vector<ros::Publisher> odometry_;
  struct PublishedRobot {
    Robot robot;
    ros::Publisher joints;
  };
  std::vector<PublishedRobot> robots_;
  std::vector<std::vector<BodyMarker>> body_markers_;
  ros::Time last_transform_stamp_;
};

}  // namespace monolith
