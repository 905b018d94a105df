#include "node/scene_lookup.h"

#include <ros/exception.h>
#include <ros/package.h>
#include <ros/param.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "node/node_options.h"
#include "scene/nearest_word.h"

namespace monolith {
namespace {

namespace fs = std::filesystem;

constexpr char kPackage[] = "monolith_tank";

}  // namespace

std::string findSceneFile(const std::string& scene) {
  const fs::path given(scene);
  std::error_code error;
  if (scene.find('/') != std::string::npos || given.extension() == ".yaml") {
    if (!fs::is_regular_file(given, error)) {
      throw SceneError("~scene: value " + scene + ": no such file: expected a readable file at " +
                       fs::absolute(given).string());
    }
    return fs::absolute(given).lexically_normal().string();
  }
  const fs::path folder = fs::path(ros::package::getPath(kPackage)) / "config/scenes";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  if (names.empty()) {
    throw SceneError("~scene: value " + scene + ": expected shipped scenes in " + folder.string() +
                     ", is the package " + kPackage + " on ROS_PACKAGE_PATH?");
  }
  if (std::find(names.begin(), names.end(), scene) == names.end()) {
    throw SceneError("~scene: value " + scene +
                     ": expected the path of a scene file or the name of a shipped scene, "
                     "the nearest is \"" +
                     nearestWord(scene, names) + "\"");
  }
  return (folder / (scene + ".yaml")).string();
}

SceneResolver makeRosResolver() {
  SceneResolver resolver;
  resolver.package_path = [](const std::string& package) { return ros::package::getPath(package); };
  resolver.parameter = [](const std::string& parameter, std::string& text) {
    try {
      return ros::param::get(parameter, text);
    } catch (const ros::Exception&) {  // no name of a parameter
      return false;
    }
  };
  resolver.name_conflict = [](const std::string& name) -> std::string {
    if (!isNodeParameter(name)) return "";
    return "another name, ~" + name + " is a parameter of the node and ~" + name +
           "/robot_description would take its place";
  };
  return resolver;
}

}  // namespace monolith
