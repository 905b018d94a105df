#pragma once
// tf frames of the node's own: the world, which several nodes may share, and under it what only one may have.

#include <string>

namespace monolith {

struct FrameNames {
  std::string world = "world";
  std::string prefix;  // of every other frame; those that nodes with one world have in common need different ones

  std::string tank() const { return prefix + world + "/tank"; }
  std::string body(const std::string& name) const { return prefix + name; }
  std::string link(const std::string& body_name, const std::string& name) const { return body(body_name) + "/" + name; }
};

}  // namespace monolith
