#include <algorithm>
#include <sstream>

#include "scene/nearest_word.h"
#include "scene/scene_sections.h"

namespace monolith {
namespace {

void readPrescribed(const YamlMap& joint, PrescribedJointMotion& motion, Violations& violations) {
  for (const char* key : {"velocity", "stiffness", "damping"}) {
    if (joint.has(key)) joint.fail(key, "none beside prescribed, which moves the joint whatever acts on it");
  }
  const YamlMap map(joint.get("prescribed"), joint.path("prescribed"), {"rate", "amplitude", "frequency", "phase"},
                    violations);
  map.read("rate", motion.rate, Range::kFinite);
  map.read("amplitude", motion.amplitude, Range::kFinite);
  map.read("frequency", motion.frequency, Range::kNotNegative);
  map.read("phase", motion.phase, Range::kFinite);
  if (motion.amplitude != 0.0 && motion.frequency == 0.0) map.fail("amplitude", "a frequency > 0 beside it");
}

void readJoint(const YAML::Node& node, const std::string& path, JointDescription& joint, Violations& violations) {
  const YamlMap map(node, path, {"position", "velocity", "stiffness", "damping", "prescribed"}, violations);
  map.read("position", joint.position, Range::kFinite);
  if (joint.position < joint.lower || joint.position > joint.upper) {
    std::ostringstream limits;
    limits << "a position within the joint's limits, from " << joint.lower << " to " << joint.upper
           << (joint.type == JointType::kRevolute ? " rad" : " m");
    map.fail("position", limits.str());
  }
  map.read("velocity", joint.velocity, Range::kFinite);
  map.read("stiffness", joint.servo.stiffness, Range::kNotNegative);
  map.read("damping", joint.servo.damping, Range::kNotNegative);
  if (map.has("prescribed")) readPrescribed(map, joint.prescribed.emplace(), violations);
}

}  // namespace

void readJoints(const YamlMap& map, std::vector<BodyDescription>& bodies, Violations& violations) {
  if (bodies.size() == 1) {
    for (const char* key : {"self_collision", "joints"}) {
      if (map.has(key)) map.fail(key, "none for a URDF without movable joints");
    }
    return;
  }
  bool self_collision = false;
  map.read("self_collision", self_collision);
  for (BodyDescription& body : bodies) body.self_collision = self_collision;
  if (!map.has("joints")) return;
  const YAML::Node joints = map.get("joints");
  std::vector<std::string> names;
  std::string all;
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    names.push_back(bodies[i].joint->name);
    all += (i > 1 ? ", " : "") + names.back();
  }
  if (!joints.IsMap()) return map.fail("joints", "a map with the URDF's movable joints as keys: " + all);
  std::vector<std::string> known = names;  // and those whose error is here: the map has none of its own for them
  for (const auto& entry : joints) {
    const std::string name = shownValue(entry.first);
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string text = map.path("joints");
    text.append(".").append(name).append(": unknown joint: expected a movable one of the URDF (").append(all);
    violations.add(entry.first, text.append("); the nearest is \"").append(nearestWord(name, names)).append("\""));
    known.push_back(name);
  }
  const YamlMap by_name(joints, map.path("joints"), known, violations);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const std::string& name = names[i - 1];
    if (by_name.has(name)) readJoint(by_name.get(name), by_name.path(name), *bodies[i].joint, violations);
  }
}

}  // namespace monolith
