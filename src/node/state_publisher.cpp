#include "node/state_publisher.h"

#include <rosgraph_msgs/Clock.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>

#include "node/markers.h"
#include "node/message_conversion.h"

namespace monolith {
namespace {

constexpr int kQueue = 100;        // small messages: none is lost to a subscriber that is briefly busy
constexpr int kSurfaceQueue = 10;

std::vector<geometry_msgs::TransformStamped> linkTransforms(const Scene& scene) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (const BodyDescription& body : scene.bodies) {
    for (std::size_t i = 1; i < body.links.size(); ++i) {
      geometry_msgs::TransformStamped transform;
      transform.header.frame_id = body.name;
      transform.child_frame_id = body.name + "/" + body.links[i].name;
      transform.transform = toTransform(body.links[i].X_BL);
      transforms.push_back(transform);
    }
  }
  return transforms;
}

}  // namespace

StatePublisher::StatePublisher(ros::NodeHandle node, ros::NodeHandle private_node, const NodeOptions& options,
                               const SimulationRunner& runner)
    : runner_(runner),
      owns_clock_(node.param("/use_sim_time", false)),
      state_gate_(options.state_rate),
      surface_gate_(options.surface_rate),
      statistics_gate_(options.statistics_rate),
      marker_gate_(options.marker_rate) {
  // Latched: who comes while the simulation is paused has a valid time at once.
  if (owns_clock_) clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", kQueue, true);
  body_states_ = private_node.advertise<monolith_tank::BodyStates>("body_states", kQueue);
  surface_ = private_node.advertise<sensor_msgs::PointCloud2>("surface", kSurfaceQueue);
  statistics_ = private_node.advertise<monolith_tank::Statistics>("statistics", kQueue);
  markers_ = private_node.advertise<visualization_msgs::MarkerArray>("markers", 1, true);
  for (const BodyDescription& body : runner.scene().bodies) {
    odometry_.push_back(private_node.advertise<nav_msgs::Odometry>(body.name + "/odom", kQueue));
    private_node.setParam(body.name + "/robot_description", body.urdf_xml);
  }
  const auto links = linkTransforms(runner.scene());
  if (!links.empty()) static_transforms_.sendTransform(links);
}

std_msgs::Header StatePublisher::header() const {
  std_msgs::Header header;
  header.stamp = runner_.stamp();
  header.frame_id = runner_.frames().worldFrame();
  return header;
}

void StatePublisher::publish(bool report, double real_time_factor) {
  const double time = runner_.clock();
  if (owns_clock_) {
    rosgraph_msgs::Clock clock;
    clock.clock = runner_.stamp();
    ros::Time::setNow(clock.clock);
    clock_.publish(clock);
  }
  if (state_gate_.due(time)) publishStates();
  if (surface_gate_.due(time) && surface_.getNumSubscribers() > 0) {
    surface_.publish(toPointCloud(header(), runner_.simulation().surfacePoints()));
  }
  if (report && statistics_gate_.due(time)) publishStatistics(real_time_factor);
  if (marker_gate_.due(time)) {
    // Stamp 0: where tf has the frames last, also while paused.
    markers_.publish(sceneMarkers(runner_.scene(), runner_.frames().worldFrame()));
  }
}

void StatePublisher::publishStates() {
  const std::vector<BodyState> states = runner_.simulation().bodyStates();
  const std::vector<BodyDescription>& bodies = runner_.scene().bodies;
  std::vector<geometry_msgs::TransformStamped> transforms;
  body_states_.publish(toBodyStates(header(), bodies, states));
  for (std::size_t b = 0; b < states.size(); ++b) {
    odometry_[b].publish(toOdometry(header(), bodies[b].name, states[b]));
    geometry_msgs::TransformStamped transform;
    transform.header = header();
    transform.child_frame_id = bodies[b].name;
    transform.transform = toTransform(states[b].X_WB);
    transforms.push_back(transform);
  }
  transforms_.sendTransform(transforms);
}

void StatePublisher::publishStatistics(double real_time_factor) {
  statistics_.publish(toStatistics(header(), runner_.simulation().report(), real_time_factor));
}

bool StatePublisher::hasSubscribers() const {
  const auto heard = [](const ros::Publisher& publisher) { return publisher.getNumSubscribers() > 0; };
  return heard(body_states_) && heard(surface_) && heard(statistics_) &&
         std::all_of(odometry_.begin(), odometry_.end(), heard);
}

}  // namespace monolith
