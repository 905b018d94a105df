#pragma once
// The node's private parameters. Meaning, unit and default of each are explained in config/node_template.yaml.

#include <XmlRpcValue.h>

#include <stdexcept>
#include <string>

#include "node/frame_names.h"

namespace monolith {

struct NodeOptions {
  std::string scene;  // required: path or name of a shipped scene
  bool paced = true;
  bool start_paused = false;
  double duration = 0.0;     // s, simulated; 0: endless
  double state_rate = 50.0;  // Hz, simulated, as all rates
  double surface_rate = 10.0;
  double statistics_rate = 10.0;
  double marker_rate = 25.0;
  FrameNames frames;
  double wrench_timeout = 0.5;  // s, simulated
  bool wait_for_subscribers = false;
  bool progress = false;
};

// what() has a line for each violation: parameter, value and what was expected.
class OptionsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// From the node's private namespace as a whole. Throws OptionsError: unknown parameters (with the nearest known
// name), wrong types, values out of range. Entries named *robot_description are URDF texts and left alone.
NodeOptions readNodeOptions(const XmlRpc::XmlRpcValue& parameters);

// Whether the node has, or may have, a private parameter of this name.
bool isNodeParameter(const std::string& name);

}  // namespace monolith
