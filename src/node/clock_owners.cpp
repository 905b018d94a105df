#include "node/clock_owners.h"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <cstdint>

namespace monolith {
namespace {

constexpr double kAnswerSec = 1.0;

bool answers(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, uri, result;
  request[0] = ros::this_node::getName();
  const XmlRpc::XmlRpcValue caller = request;
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, false)) return false;
  if (!ros::network::splitURI(static_cast<std::string>(uri), host, port)) return false;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  if (!client.executeNonBlock("getPid", caller)) return false;
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client, XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  dispatch.work(kAnswerSec);  // less if it answers, or if nobody is there, which is an empty result
  return client.executeCheckDone(result) && result.valid();
}

}  // namespace

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
      if (name != ros::this_node::getName() && answers(name)) owners.push_back(name);
    }
  }
  return owners;
}

}  // namespace monolith
