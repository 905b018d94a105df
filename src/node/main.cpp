// monolith_tank_node: rigid bodies in a tank of liquid. Interface: README.md; parameters: config/node_template.yaml.

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "node/node_options.h"
#include "node/scene_lookup.h"
#include "node/tank_node.h"

namespace {

// A line for each of several violations.
void logFatal(const std::string& what) { ROS_FATAL_STREAM("Cannot start:\n" << what); }

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "monolith_tank_node");
  ros::NodeHandle global;
  ros::NodeHandle local("~");
  try {
    XmlRpc::XmlRpcValue parameters;
    ros::param::get(local.getNamespace(), parameters);
    const monolith::NodeOptions options = monolith::readNodeOptions(parameters);
    const monolith::Scene scene =
        monolith::loadScene(monolith::findSceneFile(options.scene), monolith::makeRosResolver());
    monolith::TankNode node(global, local, *ros::getGlobalCallbackQueue(), options, scene);
    ROS_INFO("Scene %s: %zu bodies, tank of %g x %g x %g m, cells of %g m", scene.name.c_str(), scene.bodies.size(),
             scene.tank.size.x(), scene.tank.size.y(), scene.tank.size.z(), scene.tank.cell_width);
    node.run();
  } catch (const std::exception& error) {
    logFatal(error.what());
    return 1;
  }
  return 0;
}
