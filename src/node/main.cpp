// monolith_tank_node: rigid bodies in a tank of liquid. Interface: README.md; parameters: config/node_template.yaml.

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "node/clock_owners.h"
#include "node/node_options.h"
#include "node/scene_lookup.h"
#include "node/tank_node.h"

namespace {

// Threads that wait for each other by spinning slow each other down a hundredfold as soon as rviz or a recorder shares
// the processor; threads that sleep at once are woken too late hundreds of times a step. So they spin for about as long
// as waking takes. What `./tank run drop --duration 4 --fast` prints last, times real time during the last second of
// it, on two cores, alone and beside a program that keeps one busy:
//   OMP_WAIT_POLICY=passive                        0.8   1.5
//   (this: GOMP_SPINCOUNT=1000)                    1.8   1.0
//   OMP_WAIT_POLICY=active GOMP_SPINCOUNT=5000     2.3   0.4
//   OMP_WAIT_POLICY=active GOMP_SPINCOUNT=300000   2.4   0.01
// OpenMP reads its settings before main(), so the program starts itself once more with the right one.
void waitBriefly(char** argv) {
  if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT")) return;
  setenv("GOMP_SPINCOUNT", "1000", 1);
  // By its own name, which is what the system then calls it. Returns only if it fails: then it is merely slower.
  std::error_code error;
  execv(std::filesystem::read_symlink("/proc/self/exe", error).c_str(), argv);
}

}  // namespace

int main(int argc, char** argv) {
  waitBriefly(argv);
  ros::init(argc, argv, "monolith_tank_node");
  ros::NodeHandle global;
  // roscpp, which has started with that, ends on SIGINT alone. What containers and services are ended with would leave
  // the node's topics and services with the master.
  std::signal(SIGTERM, [](int) { ros::requestShutdown(); });
  ros::NodeHandle local("~");
  std::unique_ptr<monolith::TankNode> node;
  try {
    XmlRpc::XmlRpcValue parameters;
    ros::param::get(local.getNamespace(), parameters);
    const monolith::NodeOptions options = monolith::readNodeOptions(parameters);
    const monolith::Scene scene =
        monolith::loadScene(monolith::findSceneFile(options.scene), monolith::makeRosResolver());
    node = std::make_unique<monolith::TankNode>(global, local, *ros::getGlobalCallbackQueue(), options, scene);
    for (const std::string& owner : monolith::otherClockOwners()) {
      ROS_WARN("%s publishes /clock too: with two clocks time jumps to and fro; run one of them on another master",
               owner.c_str());
    }
    ROS_INFO("Scene %s: %zu bodies, tank of %g x %g x %g m, cells of %g m", scene.name.c_str(), scene.bodies.size(),
             scene.tank.size.x(), scene.tank.size.y(), scene.tank.size.z(), scene.tank.cell_width);
  } catch (const std::exception& error) {
    ROS_FATAL("Cannot start:\n%s", error.what());
    return 1;
  }
  try {
    return node->run() ? 0 : 1;
  } catch (const std::exception& error) {
    ROS_FATAL("Stopped at %g s: %s", node->time(), error.what());
    return 1;
  }
}
