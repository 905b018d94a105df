#pragma once
// The rules of the house, as functions from files to violations, so that they can be tested themselves.
// Each violation is a line "FILE:LINE: what is wrong" or "FILE: what is wrong".

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace monolith {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;  // path relative to the repository -> text
using Violations = std::vector<std::string>;

constexpr int kMaximumLines = 600;
constexpr std::size_t kMaximumColumns = 120;

struct Import {
  int line;
  std::string path;
  bool quoted;
};

// Rooms of src/, each with those that it may import from beside itself.
inline const std::map<std::string, std::set<std::string>>& allowedImports() {
  static const std::map<std::string, std::set<std::string>> allowed = {
      {"node", {"simulation", "scene", "rigid", "fluid", "geometry"}},
      {"simulation", {"coupling", "fluid", "rigid", "scene", "geometry", "solve"}},
      {"coupling", {"fluid", "rigid", "geometry", "solve"}},
      {"fluid", {"geometry", "solve"}},
      {"rigid", {"geometry", "scene"}},
      {"scene", {"geometry"}},
      {"geometry", {}},
      {"solve", {}},
  };
  return allowed;
}

inline bool isRos(const std::string& import) {
  static const std::regex ros(
      "(ros|roscpp|roslib|rosbag|rosconsole|rosgraph|tf|tf2|tf2_[a-z_]+|urdf|monolith_tank|std_srvs|[a-z0-9_]+_msgs|"
      "diagnostic_updater|message_filters|xmlrpcpp)/.*|XmlRpc.*");
  return std::regex_match(import, ros);
}

inline bool hasEnding(const std::string& path, const std::string& ending) {
  return path.size() >= ending.size() && path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

inline std::vector<std::string> splitLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline std::vector<Import> importsOf(const std::string& text) {
  static const std::regex pattern("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<Import> imports;
  int number = 0;
  for (const std::string& line : splitLines(text)) {
    ++number;
    std::smatch match;
    if (std::regex_match(line, match, pattern)) imports.push_back({number, match[2], match[1] == "\""});
  }
  return imports;
}

// src/ROOM/... -> ROOM; "" for what is not in a room.
inline std::string roomOf(const std::string& path) {
  const std::string prefix = "src/";
  const auto end = path.find('/', prefix.size());
  if (path.compare(0, prefix.size(), prefix) != 0 || end == std::string::npos) return "";
  return path.substr(prefix.size(), end - prefix.size());
}

inline std::string located(const std::string& path, int line, const std::string& what) {
  return path + ":" + std::to_string(line) + ": " + what;
}

inline void checkImport(const Files& files, const std::string& path, const Import& import, Violations& violations) {
  const std::string room = roomOf(path);
  if (isRos(import.path)) {
    if (room != "node") violations.push_back(located(path, import.line, "ROS outside src/node: " + import.path));
    return;
  }
  const std::string imported = "src/" + import.path;
  const std::string other = roomOf(imported);
  if (!allowedImports().count(other)) {
    // Of the system or a library; but "name.h" and "../room/name.h" would slip past the rules.
    if (import.quoted || import.path.find("..") != std::string::npos) {
      violations.push_back(located(path, import.line, "expected \"ROOM/FILE\" or <LIBRARY>: " + import.path));
    }
    return;
  }
  if (!files.count(imported)) violations.push_back(located(path, import.line, "no such file: " + imported));
  if (other != room && !allowedImports().at(room).count(other)) {
    violations.push_back(located(path, import.line, room + " may not import from " + other + ": " + import.path));
  }
}

// Depth first; open holds the way from the start to path.
inline void followImports(const Files& files, const std::string& path, std::vector<std::string>& open,
                          std::set<std::string>& done, Violations& violations) {
  const auto start = std::find(open.begin(), open.end(), path);
  if (start != open.end()) {
    std::string cycle = path + ": imports itself by way of";
    for (auto step = start + 1; step != open.end(); ++step) cycle += " " + *step;
    violations.push_back(cycle);
    return;
  }
  if (done.count(path) || !files.count(path)) return;
  open.push_back(path);
  for (const Import& import : importsOf(files.at(path))) {
    followImports(files, "src/" + import.path, open, done, violations);
  }
  open.pop_back();
  done.insert(path);
}

inline std::string readText(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// All text files below the given files and folders of the repository. Throws if one is not there.
inline Files readFiles(const std::string& repository, const std::vector<std::string>& paths) {
  Files files;
  const auto add = [&](const fs::path& path) {
    std::string text = readText(path);
    if (text.find('\0') != std::string::npos) return;  // a mesh or a picture
    files[fs::relative(path, repository).generic_string()] = std::move(text);
  };
  for (const std::string& name : paths) {
    const fs::path path = fs::path(repository) / name;
    if (!fs::exists(path)) throw std::runtime_error(path.string() + ": no such file or folder");
    if (fs::is_regular_file(path)) {
      add(path);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().extension() != ".pyc") add(entry.path());
    }
  }
  return files;
}

// Sources import from rooms below theirs only, what they import from the house exists, and ROS stays in src/node.
inline Violations findForbiddenImports(const Files& files) {
  Violations violations;
  for (const auto& [path, text] : files) {
    if (!allowedImports().count(roomOf(path))) {
      violations.push_back(path + ": in no room of the house");
      continue;
    }
    for (const Import& import : importsOf(text)) checkImport(files, path, import, violations);
  }
  return violations;
}

// No two files import each other, be it by way of others.
inline Violations findImportCycles(const Files& files) {
  Violations violations;
  std::vector<std::string> open;
  std::set<std::string> done;
  for (const auto& [path, text] : files) followImports(files, path, open, done, violations);
  return violations;
}

// Headers open with #pragma once.
inline Violations findUnguardedHeaders(const Files& files) {
  Violations violations;
  for (const auto& [path, text] : files) {
    if (!hasEnding(path, ".h")) continue;
    const std::vector<std::string> lines = splitLines(text);
    if (lines.empty() || lines.front() != "#pragma once") {
      violations.push_back(path + ": does not open with #pragma once");
    }
  }
  return violations;
}

inline Violations findLongFiles(const Files& files) {
  Violations violations;
  for (const auto& [path, text] : files) {
    const auto lines = splitLines(text).size();
    if (lines > static_cast<std::size_t>(kMaximumLines)) {
      violations.push_back(path + ": " + std::to_string(lines) + " lines, expected at most " +
                           std::to_string(kMaximumLines));
    }
  }
  return violations;
}

// Of code: texts and tables have lines as long as they need.
inline Violations findWideLines(const Files& files) {
  Violations violations;
  for (const auto& [path, text] : files) {
    if (!hasEnding(path, ".h") && !hasEnding(path, ".cpp") && !hasEnding(path, ".py")) continue;
    int number = 0;
    for (const std::string& line : splitLines(text)) {
      ++number;
      if (line.size() > kMaximumColumns) {
        violations.push_back(
            located(path, number,
                    std::to_string(line.size()) + " columns, expected at most " + std::to_string(kMaximumColumns)));
      }
    }
  }
  return violations;
}

// Marks of unfinished work, references to a document that is not part of the repository, and absolute paths that hold
// on one machine only.
inline Violations findForbiddenWords(const Files& files) {
  // Put together from pieces, so that this file passes too.
  static const std::regex unfinished(std::string("\\b(TO") + "DO|FIX" + "ME|XX" + "X|HA" + "CK)\\b");
  static const std::regex elsewhere(std::string("\\bDES") + "IGN\\b");
  static const std::regex machine_path(std::string("(^|[^A-Za-z0-9_.~$}>-])/(ho") + "me|ro" + "ot|wo" + "rk|Us" +
                                       "ers)/[A-Za-z0-9_.-]");
  Violations violations;
  for (const auto& [path, text] : files) {
    int number = 0;
    for (const std::string& line : splitLines(text)) {
      ++number;
      std::smatch match;
      if (std::regex_search(line, match, unfinished)) {
        violations.push_back(located(path, number, "unfinished: " + match.str()));
      }
      if (std::regex_search(line, match, elsewhere)) {
        violations.push_back(located(path, number, "a document that is not here: " + match.str()));
      }
      if (std::regex_search(line, match, machine_path)) {
        violations.push_back(located(path, number, "a path of one machine: " + match.str()));
      }
    }
  }
  return violations;
}

}  // namespace monolith
