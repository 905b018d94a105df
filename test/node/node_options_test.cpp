// The node's parameters: defaults, values, and what is said about wrong ones.

#include "node/node_options.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <limits>
#include <set>

namespace monolith {
namespace {

using XmlRpc::XmlRpcValue;

const std::string kSource = MONOLITH_SOURCE_DIR;

XmlRpcValue minimal() {
  XmlRpcValue parameters;
  parameters["scene"] = "drop";
  return parameters;
}

std::string errorOf(const XmlRpcValue& parameters) {
  try {
    readNodeOptions(parameters);
  } catch (const OptionsError& error) {
    return error.what();
  }
  return "";
}

void expectError(const std::string& name, const XmlRpcValue& value, const std::string& part) {
  XmlRpcValue parameters = minimal();
  parameters[name] = value;
  const std::string error = errorOf(parameters);
  EXPECT_NE(error.find("~" + name), std::string::npos) << error;
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

// As roslaunch puts a YAML file on the parameter server.
XmlRpcValue load(const std::string& file) {
  XmlRpcValue parameters;
  for (const auto& entry : YAML::LoadFile(file)) {
    const auto name = entry.first.as<std::string>();
    bool flag;
    double number;
    if (YAML::convert<bool>::decode(entry.second, flag)) {
      parameters[name] = flag;
    } else if (YAML::convert<double>::decode(entry.second, number)) {
      parameters[name] = number;
    } else {
      parameters[name] = entry.second.as<std::string>();
    }
  }
  return parameters;
}

TEST(NodeOptions, ValuesAreRead) {
  XmlRpcValue parameters = minimal();
  parameters["paced"] = false;
  parameters["duration"] = 3;  // YAML's whole numbers are numbers too
  parameters["state_rate"] = 12.5;
  parameters["world_frame"] = "tank_world";
  parameters["frame_prefix"] = "left/";
  const NodeOptions options = readNodeOptions(parameters);
  EXPECT_EQ(options.scene, "drop");
  EXPECT_FALSE(options.paced);
  EXPECT_EQ(options.duration, 3.0);
  EXPECT_EQ(options.state_rate, 12.5);
  EXPECT_EQ(options.frames.world, "tank_world");
  EXPECT_EQ(options.frames.prefix, "left/");
}

TEST(NodeOptions, WrongValuesAreNamedWithWhatWasExpected) {
  for (const char* rate :
       {"state_rate", "surface_rate", "statistics_rate", "marker_rate", "wrench_timeout", "diagnostic_period"}) {
    expectError(rate, 0.0, "value 0: expected a finite number > 0");
    expectError(rate, -1, "value -1");
    expectError(rate, std::numeric_limits<double>::quiet_NaN(), "> 0");
    expectError(rate, std::numeric_limits<double>::infinity(), "> 0");
    expectError(rate, "fast", "value fast");
  }
  expectError("duration", -0.5, ">= 0");
  expectError("duration", 5e9, "at most 4e9 s");
  expectError("paced", 1, "true or false");
  expectError("scene", 7, "a text");
  expectError("scene", "", "a scene file");
  expectError("world_frame", "", "a tf frame");
  expectError("world_frame", "/world", "slash");
  expectError("frame_prefix", "/left", "slash");
}

TEST(NodeOptions, SceneIsRequired) {
  EXPECT_NE(errorOf(XmlRpcValue()).find("~scene: missing"), std::string::npos);
  EXPECT_NE(errorOf(XmlRpcValue("text")).find("~scene: missing"), std::string::npos);
}

TEST(NodeOptions, UnknownParametersAreErrorsThatNameTheNearest) {
  XmlRpcValue parameters = minimal();
  parameters["start_pause"] = true;
  parameters["surfacerate"] = 3.0;
  const std::string error = errorOf(parameters);
  EXPECT_NE(error.find("~start_pause: unknown parameter"), std::string::npos) << error;
  EXPECT_NE(error.find("~start_paused"), std::string::npos);
  EXPECT_NE(error.find("~surface_rate"), std::string::npos);
}

TEST(NodeOptions, RobotDescriptionsOfAnEarlierRunAreNotErrors) {
  XmlRpcValue parameters = minimal();
  parameters["ball"]["robot_description"] = "<robot/>";
  EXPECT_EQ(errorOf(parameters), "");
  parameters["ball"]["colour"] = "red";
  EXPECT_NE(errorOf(parameters).find("~ball"), std::string::npos);
}

TEST(NodeOptions, NamesOfParametersAreKnown) {
  for (const char* name : {"scene", "paced", "duration", "diagnostic_period", "robot_description"}) {
    EXPECT_TRUE(isNodeParameter(name)) << name;
  }
  for (const char* name : {"ball", "pace", ""}) EXPECT_FALSE(isNodeParameter(name)) << name;
}

TEST(NodeTemplate, NamesEveryParameterWithItsDefault) {
  const NodeOptions given = readNodeOptions(load(kSource + "/config/node_template.yaml"));
  const NodeOptions defaults;
  EXPECT_EQ(given.paced, defaults.paced);
  EXPECT_EQ(given.start_paused, defaults.start_paused);
  EXPECT_EQ(given.duration, defaults.duration);
  EXPECT_EQ(given.wait_for_subscribers, defaults.wait_for_subscribers);
  EXPECT_EQ(given.state_rate, defaults.state_rate);
  EXPECT_EQ(given.surface_rate, defaults.surface_rate);
  EXPECT_EQ(given.statistics_rate, defaults.statistics_rate);
  EXPECT_EQ(given.marker_rate, defaults.marker_rate);
  EXPECT_EQ(given.frames.world, defaults.frames.world);
  EXPECT_EQ(given.frames.prefix, defaults.frames.prefix);
  EXPECT_EQ(given.wrench_timeout, defaults.wrench_timeout);
  EXPECT_EQ(given.progress, defaults.progress);
  std::set<std::string> names;
  for (const auto& entry : YAML::LoadFile(kSource + "/config/node_template.yaml")) {
    names.insert(entry.first.as<std::string>());
  }
  EXPECT_EQ(names, (std::set<std::string>{"scene", "paced", "start_paused", "duration", "wait_for_subscribers",
                                          "state_rate", "surface_rate", "statistics_rate", "marker_rate", "world_frame",
                                          "frame_prefix", "wrench_timeout", "progress", "diagnostic_period"}));
}

}  // namespace
}  // namespace monolith
