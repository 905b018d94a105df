#include "node/state_publisher.h"

#include <monolith_tank/BodyStates.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstdint>
#include <limits>
#include <stdexcept>

#include "node/message_conversion.h"
#include "node/point_cloud.h"
#include "node/tank_markers.h"

namespace monolith {
namespace {

// Deep enough that a reader that is slow for a moment misses nothing of an unpaced run.
constexpr int kQueueSize = 1000;
constexpr int kLargeQueueSize = 100;
constexpr std::uint32_t kLatestStampSec = std::numeric_limits<std::uint32_t>::max();

}  // namespace

StatePublisher::StatePublisher(ros::NodeHandle& global, ros::NodeHandle& local, const NodeOptions& options,
                               const Simulation& simulation)
    : local_(local),
      simulation_(simulation),
      frames_(options.frames),
      owns_clock_(ros::Time::isSimTime()),
      state_rhythm_{PublishGate(options.state_rate, simulation.scene().time_step)},
      surface_rhythm_{PublishGate(options.surface_rate, simulation.scene().time_step)},
      statistics_rhythm_{PublishGate(options.statistics_rate, simulation.scene().time_step)},
      marker_rhythm_{PublishGate(options.marker_rate, simulation.scene().time_step)} {
  if (owns_clock_) clock_ = global.advertise<rosgraph_msgs::Clock>("/clock", kQueueSize);
  // Latched: whoever comes while the simulation is paused sees where it stands.
  tf_ = global.advertise<tf2_msgs::TFMessage>("/tf", kQueueSize, true);
  tf_static_ = global.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
  states_ = local.advertise<monolith_tank::BodyStates>("body_states", kQueueSize, true);
  surface_ = local.advertise<sensor_msgs::PointCloud2>("surface", kLargeQueueSize, true);
  statistics_ = local.advertise<monolith_tank::Statistics>("statistics", kQueueSize, true);
  markers_ = local.advertise<visualization_msgs::MarkerArray>("markers", kLargeQueueSize, true);
  tank_ = local.advertise<visualization_msgs::MarkerArray>("tank", 1, true);
  const std::vector<BodyDescription>& bodies = simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    odometry_.push_back(local.advertise<nav_msgs::Odometry>(bodies[b].name + "/odom", kQueueSize, true));
    std::vector<std::string> warnings;
    body_markers_.push_back(makeBodyMarkers(bodies[b], static_cast<int>(b), warnings));
    for (const std::string& warning : warnings) ROS_WARN_STREAM(warning);
  }
  for (const Robot& robot : findRobots(simulation.scene())) {
    robots_.push_back(
        {robot, local.advertise<sensor_msgs::JointState>(robot.name + "/joint_states", kQueueSize, true)});
  }
}

ros::Time StatePublisher::stamp() const {
  const double seconds = simulation_.time() + simulation_.scene().time_step;
  if (seconds > kLatestStampSec) {
    throw std::runtime_error("stamp of the next state: value " + std::to_string(seconds) + " s: expected at most " +
                             std::to_string(kLatestStampSec) + " s, the latest time that ROS can hold");
  }
  return ros::Time(seconds);
}

std_msgs::Header StatePublisher::header() const {
  std_msgs::Header header;
  header.stamp = stamp();
  header.frame_id = frames_.world;
  return header;
}

void StatePublisher::publishConstant() {
  tank_.publish(makeTankMarkers(simulation_.scene().tank, frames_.world));
  tf2_msgs::TFMessage frames;
  // The tank's corner. It also makes the world frame known to tf while nothing moves.
  geometry_msgs::TransformStamped corner;
  corner.header = header();
  corner.child_frame_id = frames_.tank();
  corner.transform.translation = toVector(simulation_.scene().tank.origin);
  corner.transform.rotation.w = 1.0;
  frames.transforms.push_back(corner);
  const Scene& scene = simulation_.scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyDescription& body = scene.bodies[b];
    if (!body.joint) local_.setParam(body.name + "/robot_description", body.urdf_xml);
    for (const NamedFrame& link : linkFrames(scene, static_cast<int>(b), frames_)) {
      geometry_msgs::TransformStamped transform;
      transform.header.stamp = stamp();
      transform.header.frame_id = frames_.body(body.name);
      transform.child_frame_id = link.frame;
      transform.transform = toTransform(link.X_BL);
      frames.transforms.push_back(transform);
    }
  }
  tf_static_.publish(frames);
}

void StatePublisher::publish(const StepReport& report, double real_time_factor, What what) {
  const ros::SteadyTime start = ros::SteadyTime::now();
  publishClock();
  const std::vector<BodyState> states = simulation_.bodyStates();
  const auto isWanted = [&](Rhythm& rhythm) {
    const bool wanted = what == What::kAll ||
                        (what == What::kMissing ? rhythm.last_step != report.step : rhythm.gate.isDue(report.step));
    if (wanted) rhythm.last_step = report.step;
    return wanted;
  };
  if (isWanted(state_rhythm_)) {
    publishTransforms(states);
    publishStates(states);
    publishOdometry(states);
    publishJoints();
  }
  if (isWanted(marker_rhythm_)) publishMarkers(states);
  if (isWanted(surface_rhythm_)) publishSurface();
  publishing_sec_ += (ros::SteadyTime::now() - start).toSec();
  if (isWanted(statistics_rhythm_)) publishStatistics(report, real_time_factor);
}

void StatePublisher::publishClock() {
  if (!owns_clock_) return;
  rosgraph_msgs::Clock message;
  message.clock = stamp();
  clock_.publish(message);
}

void StatePublisher::setRosTime() const {
  if (owns_clock_) ros::Time::setNow(stamp());
}

void StatePublisher::publishTransforms(const std::vector<BodyState>& states) {
  // tf ignores a second pose of the same time, with a warning in every listener.
  if (stamp() == last_transform_stamp_) return;
  last_transform_stamp_ = stamp();
  tf2_msgs::TFMessage message;
  for (std::size_t b = 0; b < states.size(); ++b) {
    geometry_msgs::TransformStamped transform;
    transform.header = header();
    transform.child_frame_id = frames_.body(simulation_.scene().bodies[b].name);
    transform.transform = toTransform(states[b].X_WB);
    message.transforms.push_back(transform);
  }
  if (!message.transforms.empty()) tf_.publish(message);
}

void StatePublisher::publishStates(const std::vector<BodyState>& states) {
  monolith_tank::BodyStates message;
  message.header = header();
  for (std::size_t b = 0; b < states.size(); ++b) {
    message.names.push_back(simulation_.scene().bodies[b].name);
    message.poses.push_back(toPose(states[b].X_WB));
    message.twists.push_back(toTwist(states[b].velocity, states[b].angular_velocity));
    message.liquid_wrenches.push_back(toWrench(states[b].liquid));
    message.contact_wrenches.push_back(toWrench(states[b].contact));
  }
  states_.publish(message);
}

void StatePublisher::publishOdometry(const std::vector<BodyState>& states) {
  for (std::size_t b = 0; b < states.size(); ++b) {
    nav_msgs::Odometry message;
    message.header = header();
    message.child_frame_id = frames_.body(simulation_.scene().bodies[b].name);
    message.pose.pose = toPose(states[b].X_WB);
    // nav_msgs/Odometry has its twist in the child frame.
    const Eigen::Matrix3d R_BW = states[b].X_WB.linear().transpose();
    message.twist.twist = toTwist(R_BW * states[b].velocity, R_BW * states[b].angular_velocity);
    odometry_[b].publish(message);
  }
}

void StatePublisher::publishJoints() {
  std::vector<JointState> by_body(simulation_.scene().bodies.size());
  for (const JointState& joint : simulation_.jointStates()) by_body[joint.body] = joint;
  for (const PublishedRobot& robot : robots_) {
    sensor_msgs::JointState message;
    message.header.stamp = stamp();
    for (const int body : robot.robot.jointed) {
      message.name.push_back(simulation_.scene().bodies[body].joint->name);
      message.position.push_back(by_body[body].position);
      message.velocity.push_back(by_body[body].velocity);
      message.effort.push_back(by_body[body].effort);
    }
    robot.joints.publish(message);
  }
}

void StatePublisher::publishMarkers(const std::vector<BodyState>& states) {
  visualization_msgs::MarkerArray message;
  for (std::size_t b = 0; b < states.size(); ++b) {
    for (const BodyMarker& part : body_markers_[b]) {
      message.markers.push_back(part.marker);
      message.markers.back().header = header();
      message.markers.back().pose = toPose(states[b].X_WB * part.X_BV);
    }
  }
  markers_.publish(message);
}

void StatePublisher::publishSurface() {
  sensor_msgs::PointCloud2 message = toPointCloud(simulation_.surfacePoints());
  message.header = header();
  surface_.publish(message);
}

void StatePublisher::publishStatistics(const StepReport& report, double real_time_factor) {
  monolith_tank::Statistics message = toStatistics(report, real_time_factor);
  message.header = header();
  message.publishing_time = publishing_sec_;
  publishing_sec_ = 0.0;
  statistics_.publish(message);
  statistics_rhythm_.last_step = report.step;  // also of a step that has failed
}

std::vector<std::string> StatePublisher::topicsWithoutSubscriber() const {
  std::vector<const ros::Publisher*> publishers = {&states_, &surface_, &statistics_};
  for (const ros::Publisher& odometry : odometry_) publishers.push_back(&odometry);
  for (const PublishedRobot& robot : robots_) publishers.push_back(&robot.joints);
  std::vector<std::string> topics;
  for (const ros::Publisher* publisher : publishers) {
    if (publisher->getNumSubscribers() == 0) topics.push_back(publisher->getTopic());
  }
  return topics;
}

}  // namespace monolith
