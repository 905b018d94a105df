#pragma once
// URDF -> one rigid body. Links joined by fixed joints become one: body frame B = frame of the root link; mass,
// centre of mass and inertia are summed; every collision shape and link frame is placed in B.

#include <string>
#include <vector>

#include "scene/scene_file.h"

namespace monolith {

struct UrdfText {
  std::string source;  // file or parameter, for messages
  std::string folder;  // that relative mesh paths start from; empty if the text is not from a file
  std::string xml;
};

// Sets source, urdf_xml, mass properties, shapes and links of `body`. In urdf_xml relative mesh paths become
// file:// references, so that it means the same to every reader. Returns what is wrong, a line each, naming the
// source, the link or joint, the value and what was expected; then `body` is only partly set.
std::vector<std::string> readUrdfBody(const UrdfText& urdf, const SceneResolver& resolver, BodyDescription& body);

}  // namespace monolith
