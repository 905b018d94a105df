#pragma once
// From the ~scene parameter to a Scene: shipped names, package:// and URDF texts on the parameter server.

#include <string>

#include "scene/scene_file.h"

namespace monolith {

// Path of a shipped scene's file if `scene` is such a name, otherwise `scene` itself taken as a path. Throws
// SceneError, with the nearest shipped name, if a bare name is neither.
std::string sceneFile(const std::string& scene);

// package:// by the package path, parameters as seen from the node's private namespace.
SceneResolver rosResolver();

}  // namespace monolith
