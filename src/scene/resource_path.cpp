#include "scene/resource_path.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace monolith {
namespace {

namespace fs = std::filesystem;

bool takePrefix(const std::string& text, const std::string& prefix, std::string& rest) {
  if (text.compare(0, prefix.size(), prefix) != 0) return false;
  rest = text.substr(prefix.size());
  return true;
}

fs::path packageFile(const std::string& reference, const std::string& rest, const SceneResolver& resolver) {
  const std::size_t slash = rest.find('/');
  const std::string package = rest.substr(0, slash);
  if (package.empty() || slash == std::string::npos || slash + 1 == rest.size()) {
    throw SceneError("\"" + reference + "\": expected package://NAME/PATH");
  }
  const std::string root = resolver.package_path ? resolver.package_path(package) : std::string();
  if (root.empty()) {
    throw SceneError("\"" + reference + "\": package \"" + package +
                     "\" not found: expected a package on ROS_PACKAGE_PATH");
  }
  return fs::path(root) / rest.substr(slash + 1);
}

}  // namespace

std::string resolveResource(const std::string& reference, const std::string& folder,
                            const SceneResolver& resolver) {
  std::string rest;
  fs::path path;
  if (reference.empty()) {
    throw SceneError("\"\": expected the path of a file");
  } else if (takePrefix(reference, "package://", rest)) {
    path = packageFile(reference, rest, resolver);
  } else if (takePrefix(reference, "file://", rest)) {
    path = rest;
    if (!path.is_absolute()) {
      throw SceneError("\"" + reference + "\": expected file:// and an absolute path");
    }
  } else if (reference.find("://") != std::string::npos) {
    throw SceneError("\"" + reference + "\": expected package://, file:// or a path");
  } else {
    path = reference;
    if (path.is_relative()) {
      if (folder.empty()) {
        throw SceneError("\"" + reference +
                         "\": relative path in a URDF that is not a file: expected package:// or file://");
      }
      path = fs::path(folder) / path;
    }
  }
  path = path.lexically_normal();
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw SceneError("\"" + reference + "\": no such file: expected a readable file at " + path.string());
  }
  return path.string();
}

std::string readTextFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw SceneError(path + ": cannot be read: expected a readable file");
  return text;
}

}  // namespace monolith
