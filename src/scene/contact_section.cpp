#include <algorithm>

#include "scene/nearest_word.h"
#include "scene/scene_sections.h"

namespace monolith {
namespace {

// Names that a pair may use: bodies, their materials and the walls.
std::vector<std::string> surfaceNames(const std::vector<BodyDescription>& bodies) {
  std::vector<std::string> names{kWallsName};
  for (const BodyDescription& body : bodies) {
    names.push_back(body.name);
    if (!body.material.empty()) names.push_back(body.material);
  }
  return names;
}

void readLaw(const YamlMap& map, double& friction, double& restitution) {
  map.read("friction", friction, Range::kNotNegative);
  map.read("restitution", restitution, Range::kNotNegative);
  if (restitution > 1.0) map.fail("restitution", "at most 1, the speed of separation over that of approach");
}

}  // namespace

void readContact(const YAML::Node& node, const std::vector<BodyDescription>& bodies, ContactDescription& contact,
                 Violations& violations) {
  const YamlMap map(node, "contact", {"friction", "restitution", "pairs"}, violations);
  readLaw(map, contact.friction, contact.restitution);
  if (!map.has("pairs")) return;
  const YAML::Node pairs = map.get("pairs");
  if (!pairs.IsSequence()) return map.fail("pairs", "a list of {between: [a, b], friction: mu, restitution: e}");
  const std::vector<std::string> names = surfaceNames(bodies);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string path = "contact.pairs[" + std::to_string(i) + "]";
    const YamlMap entry(pairs[i], path, {"between", "friction", "restitution"}, violations);
    entry.require("between", "two names of bodies or materials, or \"walls\"");
    ContactDescription::Pair pair;
    pair.friction = contact.friction;
    pair.restitution = contact.restitution;
    readLaw(entry, pair.friction, pair.restitution);
    if (!entry.has("between")) continue;
    const YAML::Node between = entry.get("between");
    if (!between.IsSequence() || between.size() != 2 || !between[0].IsScalar() || !between[1].IsScalar()) {
      entry.fail("between", "two names of bodies or materials, or \"walls\"");
      continue;
    }
    pair.a = between[0].as<std::string>();
    pair.b = between[1].as<std::string>();
    for (const std::string& name : {pair.a, pair.b}) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      entry.fail("between", "names of bodies or materials of this scene, or \"walls\"; the nearest to " + name +
                                " is " + nearestWord(name, names));
    }
    const bool body = std::any_of(bodies.begin(), bodies.end(), [&](const auto& b) { return b.name == pair.a; });
    if (pair.a == pair.b && (body || pair.a == kWallsName)) {
      entry.fail("between", "two that can touch, not one thing and itself");
    }
    const bool repeats = std::any_of(contact.pairs.begin(), contact.pairs.end(), [&](const auto& other) {
      return (other.a == pair.a && other.b == pair.b) || (other.a == pair.b && other.b == pair.a);
    });
    if (repeats) entry.fail("between", "a pair that no entry before has");
    contact.pairs.push_back(pair);
  }
}

}  // namespace monolith
