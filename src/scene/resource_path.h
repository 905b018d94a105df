#pragma once
// Where the files are that a scene or a URDF refers to: "package://NAME/...", "file://...", an absolute path, or a
// path relative to the folder of the file that has the reference.

#include <string>

#include "scene/scene_file.h"

namespace monolith {

// Path of an existing regular file. Throws SceneError naming the reference and the path tried. An empty
// `folder` means that there is nothing to be relative to.
std::string resolveResource(const std::string& reference, const std::string& folder,
                            const SceneResolver& resolver);

// Whole text of a file. Throws SceneError if it cannot be read.
std::string readTextFile(const std::string& path);

}  // namespace monolith
