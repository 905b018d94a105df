#include "node/clock_owners.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace monolith {

std::vector<std::string> otherClockOwners() {
  std::vector<std::string> owners;
  XmlRpc::XmlRpcValue request, response, state;  // state: publishers, subscribers, services; each [topic, [node]]
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return owners;
  XmlRpc::XmlRpcValue& published = state[0];
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) != "/clock") continue;
    for (int n = 0; n < published[i][1].size(); ++n) {
      const std::string name = published[i][1][n];
      if (name != ros::this_node::getName()) owners.push_back(name);
    }
  }
  return owners;
}

}  // namespace monolith
