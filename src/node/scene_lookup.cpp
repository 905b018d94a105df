#include "node/scene_lookup.h"

#include <ros/node_handle.h>
#include <ros/package.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "scene/yaml_map.h"

namespace monolith {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> shippedScenes(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::string sceneFile(const std::string& scene) {
  const fs::path path(scene);
  if (path.has_parent_path() || path.has_extension() || fs::exists(path)) return scene;
  const std::string package = ros::package::getPath("monolith_tank");
  const fs::path folder = fs::path(package) / "config" / "scenes";
  const fs::path shipped = folder / (scene + ".yaml");
  if (!package.empty() && fs::exists(shipped)) return shipped.string();
  const std::vector<std::string> names = shippedScenes(folder);
  std::string message = "scene \"" + scene + "\": no shipped scene and no file of that name";
  if (names.empty()) {
    message += ": expected package monolith_tank on ROS_PACKAGE_PATH, or the path of a scene file";
  } else {
    message += ": nearest shipped scene is \"" + nearestWord(scene, names) + "\" in " + folder.string();
  }
  throw SceneError(message);
}

SceneResolver rosResolver() {
  SceneResolver resolver;
  resolver.package_path = [](const std::string& package) { return ros::package::getPath(package); };
  resolver.parameter = [](const std::string& parameter, std::string& text) {
    return ros::NodeHandle("~").getParam(parameter, text);
  };
  return resolver;
}

}  // namespace monolith
