#include "scene/scene_file.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <vector>

#include "scene/resource_path.h"
#include "scene/scene_memory.h"
#include "scene/scene_sections.h"
#include "scene/yaml_map.h"

namespace monolith {
namespace {

namespace fs = std::filesystem;

constexpr double kStrongestGravity = 1e6;  // m/s^2; speeds that follow from much more leave the range of numbers
constexpr double kLongestTimeStep = 1e6;  // s; with longer ones there are hardly any until clocks overflow

YAML::Node parseYaml(const std::string& yaml_file) {
  std::error_code error;
  if (!fs::is_regular_file(yaml_file, error)) {
    throw SceneError(yaml_file + ": no such file: expected a scene file (YAML)");
  }
  const std::string text = readTextFile(yaml_file);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    for (std::size_t i = 1; i < documents.size(); ++i) {
      if (documents[i].IsNull()) continue;  // after a last ---
      throw SceneError(yaml_file + ":" + std::to_string(documents[i].Mark().line + 1) +
                       ": a further YAML document: expected one, without a line --- within it");
    }
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& exception) {
    throw SceneError(yaml_file + ":" + std::to_string(exception.mark.line + 1) + ": malformed YAML at column " +
                     std::to_string(exception.mark.column + 1) + ": " + exception.msg + ": expected valid YAML");
  }
}

void readBodies(const YamlMap& map, const std::string& folder, const SceneResolver& resolver, bool tank_usable,
                Scene& scene, Violations& violations) {
  if (!map.has("bodies")) return;
  const YAML::Node bodies = map.get("bodies");
  if (!bodies.IsSequence()) return map.fail("bodies", "a list, each entry with name and urdf");
  std::map<std::string, std::size_t> first_use;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::size_t violations_before = violations.count();
    std::vector<BodyDescription> read =
        readBody(bodies[i], static_cast<int>(i), static_cast<int>(scene.bodies.size()), folder, resolver, violations);
    // Those beyond joints are called after it.
    const std::string& name = read.front().name;
    const auto [first, is_new] = first_use.emplace(name, i);
    if (!is_new && !name.empty()) {
      violations.add(bodies[i], "bodies[" + std::to_string(i) + "].name: value " + name +
                                    ": expected a name of its own, bodies[" + std::to_string(first->second) +
                                    "] has it already");
    }
    // The pose may be a default that stands in for a wrong value.
    if (tank_usable && violations.count() == violations_before) {
      for (const BodyDescription& body : read) checkInsideTank(body, bodies[i], scene.tank, violations);
    }
    std::move(read.begin(), read.end(), std::back_inserter(scene.bodies));
  }
}

}  // namespace

Scene loadScene(const std::string& yaml_file, const SceneResolver& resolver) {
  const YAML::Node root = parseYaml(yaml_file);
  Violations violations(yaml_file);
  const YamlMap map(root, "", {"tank", "name", "liquid", "gravity", "time_step", "contact", "solver", "bodies"},
                    violations);
  Scene scene;
  scene.source = yaml_file;
  scene.name = fs::path(yaml_file).stem().string();
  map.read("name", scene.name);
  map.read<3>("gravity", scene.gravity);
  if (scene.gravity.norm() > kStrongestGravity) map.fail("gravity", "at most 1e6 m/s^2");
  map.read("time_step", scene.time_step, Range::kPositive);
  if (scene.time_step > kLongestTimeStep) map.fail("time_step", "at most 1e6 s");
  bool tank_usable = false;
  if (root.IsMap()) map.require("tank", "a map with size and cell_width");
  if (map.has("tank")) tank_usable = readTank(map.get("tank"), scene.tank, violations);
  if (map.has("liquid")) readLiquid(map.get("liquid"), scene.tank, tank_usable, scene.liquid, violations);
  if (map.has("solver")) readSolver(map.get("solver"), scene.solver, violations);
  // A dry tank has no cells.
  const bool dry = !scene.liquid.any();
  if (tank_usable && !dry) checkMemory(map.get("tank"), scene, usableMemory(), violations);
  const std::string folder = fs::absolute(yaml_file).parent_path().string();
  readBodies(map, folder, resolver, tank_usable, scene, violations);
  if (map.has("contact")) readContact(map.get("contact"), scene.bodies, scene.contact, violations);
  violations.throwIfAny();
  return scene;
}

}  // namespace monolith
