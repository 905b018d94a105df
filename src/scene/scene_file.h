#pragma once
// YAML + URDF -> Scene. The keys and their units are explained in config/scene_template.yaml.

#include <functional>
#include <string>

#include "scene/scene.h"

namespace monolith {

// How a scene's references are resolved. Each may be empty: references of that kind are then errors.
struct SceneResolver {
  // "package://NAME/..." -> path; returns "" for an unknown package.
  std::function<std::string(const std::string& package)> package_path;
  // ROS parameter -> URDF text; returns false if there is none.
  std::function<bool(const std::string& parameter, std::string& text)> parameter;
  // What was expected instead of this name of a body; returns "" if it is as good as any.
  std::function<std::string(const std::string& name)> name_conflict;
};

// Throws SceneError naming file, line, element, value and what was expected; all violations at once.
Scene loadScene(const std::string& yaml_file, const SceneResolver& resolver);

}  // namespace monolith
