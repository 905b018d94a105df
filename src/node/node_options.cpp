#include "node/node_options.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "scene/nearest_word.h"

namespace monolith {
namespace {

using XmlRpc::XmlRpcValue;

constexpr double kLongestDurationSec = 4e9;  // of the 2^32 that ROS can hold; a stamp is a time step later

std::string shown(const XmlRpcValue& value) {
  std::ostringstream text;
  value.write(text);
  return text.str();
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// BODY/robot_description is set by this node; other URDF texts are what a scene's urdf_parameter may refer to.
bool isRobotDescription(const std::string& name, const XmlRpcValue& value) {
  if (endsWith(name, "robot_description")) return true;
  if (value.getType() != XmlRpcValue::TypeStruct) return false;
  XmlRpcValue entries = value;
  return std::all_of(entries.begin(), entries.end(),
                     [](const auto& entry) { return isRobotDescription(entry.first, entry.second); });
}

class ParameterReader {
 public:
  explicit ParameterReader(const XmlRpcValue& parameters) : parameters_(parameters) {}

  void read(const std::string& name, bool& out) {
    if (!takes(name)) return;
    const XmlRpcValue& value = parameters_[name];
    if (value.getType() != XmlRpcValue::TypeBoolean) return fail(name, "true or false");
    out = static_cast<bool>(XmlRpcValue(value));
  }

  void read(const std::string& name, double& out, bool zero_allowed) {
    if (!takes(name)) return;
    XmlRpcValue value = parameters_[name];
    double number = std::nan("");
    if (value.getType() == XmlRpcValue::TypeInt) number = static_cast<int>(value);
    if (value.getType() == XmlRpcValue::TypeDouble) number = static_cast<double>(value);
    const bool good = std::isfinite(number) && (number > 0.0 || (zero_allowed && number == 0.0));
    if (!good) return fail(name, zero_allowed ? "a finite number >= 0" : "a finite number > 0");
    out = number;
  }

  void read(const std::string& name, std::string& out) {
    if (!takes(name)) return;
    XmlRpcValue value = parameters_[name];
    if (value.getType() != XmlRpcValue::TypeString) return fail(name, "a text");
    out = static_cast<std::string>(value);
  }

  void require(bool fulfilled, const std::string& name, const std::string& expected) {
    if (!fulfilled) fail(name, expected);
  }

  bool knows(const std::string& name) const { return std::count(known_.begin(), known_.end(), name) > 0; }

  // Call last: what has not been read until now is unknown.
  void finish() {
    if (parameters_.getType() == XmlRpcValue::TypeStruct) {
      for (const auto& entry : parameters_) {
        if (knows(entry.first) || isRobotDescription(entry.first, entry.second)) continue;
        add("~" + entry.first + ": unknown parameter: expected another, the nearest is ~" +
            nearestWord(entry.first, known_));
      }
    }
    if (!errors_.empty()) throw OptionsError(errors_);
  }

 private:
  bool takes(const std::string& name) {
    known_.push_back(name);
    return parameters_.getType() == XmlRpcValue::TypeStruct && parameters_.hasMember(name);
  }

  void fail(const std::string& name, const std::string& expected) {
    const bool present = parameters_.getType() == XmlRpcValue::TypeStruct && parameters_.hasMember(name);
    add("~" + name + ": " + (present ? "value " + shown(parameters_[name]) : "missing") + ": expected " + expected);
  }

  void add(const std::string& line) { errors_ += (errors_.empty() ? "" : "\n") + line; }

  XmlRpcValue parameters_;
  std::vector<std::string> known_;
  std::string errors_;
};

NodeOptions readAll(ParameterReader& reader) {
  NodeOptions options;
  reader.read("scene", options.scene);
  reader.read("paced", options.paced);
  reader.read("start_paused", options.start_paused);
  reader.read("duration", options.duration, true);
  reader.read("state_rate", options.state_rate, false);
  reader.read("surface_rate", options.surface_rate, false);
  reader.read("statistics_rate", options.statistics_rate, false);
  reader.read("marker_rate", options.marker_rate, false);
  reader.read("world_frame", options.frames.world);
  reader.read("frame_prefix", options.frames.prefix);
  reader.read("wrench_timeout", options.wrench_timeout, false);
  reader.read("wait_for_subscribers", options.wait_for_subscribers);
  reader.read("progress", options.progress);
  // diagnostic_updater reads it by itself, and takes what is no number for its default.
  double diagnostic_period = 1.0;
  reader.read("diagnostic_period", diagnostic_period, false);
  reader.require(!options.scene.empty(), "scene", "the path of a scene file or the name of a shipped scene");
  reader.require(!options.frames.world.empty() && options.frames.world[0] != '/', "world_frame",
                 "a tf frame without a leading slash");
  reader.require(options.frames.prefix.empty() || options.frames.prefix[0] != '/', "frame_prefix",
                 "the beginning of tf frames, without a leading slash");
  reader.require(options.duration <= kLongestDurationSec, "duration", "at most 4e9 s, ROS cannot hold later times");
  return options;
}

}  // namespace

NodeOptions readNodeOptions(const XmlRpcValue& parameters) {
  ParameterReader reader(parameters);
  const NodeOptions options = readAll(reader);
  reader.finish();
  return options;
}

bool isNodeParameter(const std::string& name) {
  ParameterReader reader{XmlRpcValue()};
  readAll(reader);
  return reader.knows(name) || endsWith(name, "robot_description");
}

}  // namespace monolith
