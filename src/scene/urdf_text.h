#pragma once
// A URDF before it is read.

#include <set>
#include <string>

namespace monolith {

struct UrdfText {
  std::string source;  // file or parameter, for messages
  std::string folder;  // that relative mesh paths start from; empty if the text is not from a file
  std::string xml;
};

// The text with file:// references instead of relative mesh paths, so that it means the same to every reader; as it is
// if none of `mesh_files`, those that it refers to, is a relative path.
std::string withAbsoluteMeshes(const UrdfText& urdf, const std::set<std::string>& mesh_files);

}  // namespace monolith
