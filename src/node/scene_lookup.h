#pragma once
// Where the node finds a scene and what it refers to: shipped scenes in this package, package:// by the ROS package
// path, URDF texts on the parameter server.

#include <string>

#include "scene/scene_file.h"

namespace monolith {

// Path of a scene file. `scene` is a path if it has a "/" or ends in .yaml, otherwise the name of a scene in the
// package's config/scenes. Throws SceneError; of an unknown name it tells the nearest known one.
std::string findSceneFile(const std::string& scene);

SceneResolver makeRosResolver();

}  // namespace monolith
