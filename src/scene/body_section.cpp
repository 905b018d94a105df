#include <cmath>
#include <filesystem>
#include <sstream>

#include "geometry/shape.h"
#include "scene/body_name.h"
#include "scene/joint_placement.h"
#include "scene/resource_path.h"
#include "scene/scene_sections.h"
#include "scene/urdf_body.h"

namespace monolith {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's norm; nearer ones are normalised

void readName(const YamlMap& map, const SceneResolver& resolver, std::string& name) {
  map.require("name", "a name for topics and tf");
  map.read("name", name);
  if (name.empty()) return;
  if (!validBodyName(name)) {
    map.fail("name", kBodyNameRule);
  } else if (name == "world") {
    map.fail("name", "another name, \"world\" is the tank's own frame");
  } else if (name == kWallsName) {
    map.fail("name", "another name, \"walls\" is the tank's own in contact.pairs");
  } else if (const std::string expected = resolver.name_conflict ? resolver.name_conflict(name) : "";
             !expected.empty()) {
    map.fail("name", expected);
  }
}

void readUrdf(const YamlMap& map, const std::string& folder, const SceneResolver& resolver, const YAML::Node& node,
              std::vector<BodyDescription>& bodies, Violations& violations) {
  if (map.has("urdf") == map.has("urdf_parameter")) {
    const std::string both = map.has("urdf") ? "both are given" : "neither is given";
    violations.add(node, map.path("urdf") + ", urdf_parameter: " + both + ": expected exactly one of them");
    return;
  }
  UrdfText urdf;
  const std::string key = map.has("urdf") ? "urdf" : "urdf_parameter";
  std::string value;
  map.read(key, value);
  if (value.empty()) return;
  try {
    if (key == "urdf") {
      urdf.source = resolveResource(value, folder, resolver);
      urdf.folder = std::filesystem::path(urdf.source).parent_path().string();
      urdf.xml = readTextFile(urdf.source);
    } else {
      urdf.source = "parameter " + value;
      if (!resolver.parameter || !resolver.parameter(value, urdf.xml)) {
        return map.fail(key, "the name of a ROS parameter that holds a URDF");
      }
    }
  } catch (const SceneError& error) {
    violations.add(map.get(key), map.path(key) + ": value " + error.what());
    return;
  }
  for (const std::string& line : readUrdfBodies(urdf, resolver, bodies)) {
    violations.add(map.get(key), map.path(key) + ": " + line);
  }
}

// Roll, pitch, yaw about the fixed axes x, y, z in this order (REP-103).
Quaterniond fromRollPitchYaw(const Vector3d& rpy) {
  return AngleAxisd(rpy.z(), Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         AngleAxisd(rpy.x(), Vector3d::UnitX());
}

Quaterniond readOrientation(const YAML::Node& node, const std::string& path, Violations& violations) {
  const YamlMap map(node, path, {"rpy", "quaternion"}, violations);
  if (map.has("rpy") == map.has("quaternion")) {
    violations.add(node, path + ": value " + shownValue(node) +
                             ": expected exactly one of rpy: [r, p, y] and quaternion: [x, y, z, w]");
    return Quaterniond::Identity();
  }
  Vector3d rpy = Vector3d::Zero();
  map.read<3>("rpy", rpy);
  if (map.has("rpy")) return fromRollPitchYaw(rpy);
  Eigen::Vector4d xyzw(0.0, 0.0, 0.0, 1.0);
  map.read<4>("quaternion", xyzw);
  if (std::abs(xyzw.norm() - 1.0) > kUnitTolerance) {
    map.fail("quaternion", "a unit quaternion [x, y, z, w], not one of norm " + std::to_string(xyzw.norm()));
    return Quaterniond::Identity();
  }
  return Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
}

void readMotion(const YamlMap& map, bool has_joints, BodyDescription& body, Violations& violations) {
  map.read("material", body.material);
  if (body.material == kWallsName) {
    map.fail("material", "another name, \"walls\" is the tank's own in contact.pairs");
  }
  const std::string motion = map.readWord("motion", "free", {"free", "fixed", "prescribed"});
  if (motion == "fixed") body.motion = BodyMotion::kFixed;
  if (motion == "prescribed") body.motion = BodyMotion::kPrescribed;
  map.read<3>("velocity", body.velocity);
  map.read<3>("angular_velocity", body.angular_velocity);
  for (const char* key : {"velocity", "angular_velocity"}) {
    if (motion != "free" && map.has(key)) map.fail(key, "none for motion: " + motion + ", only for motion: free");
  }
  if ((motion == "prescribed") != map.has("prescribed")) {
    if (map.has("prescribed")) return map.fail("prescribed", "none unless motion: prescribed is given too");
    return map.require("prescribed", "a map with a twist or an amplitude, for motion: prescribed");
  }
  if (motion != "prescribed") return;
  const YamlMap prescribed(map.get("prescribed"), map.path("prescribed"),
                           {"twist", "amplitude", "frequency", "phase", "in_place"}, violations);
  prescribed.read<6>("twist", body.prescribed.twist);
  prescribed.read<6>("amplitude", body.prescribed.amplitude);
  prescribed.read("frequency", body.prescribed.frequency, Range::kNotNegative);
  prescribed.read("phase", body.prescribed.phase, Range::kFinite);
  prescribed.read("in_place", body.prescribed.in_place);
  if (body.prescribed.in_place && has_joints) {
    prescribed.fail("in_place", "false for a URDF with movable joints, whose bodies hang on the one that moves");
  }
  if (!body.prescribed.amplitude.isZero(0.0) && body.prescribed.frequency == 0.0) {
    prescribed.fail("amplitude", "a frequency > 0 beside it");
  }
}

}  // namespace

std::vector<BodyDescription> readBody(const YAML::Node& node, int index, int first, const std::string& folder,
                                      const SceneResolver& resolver, Violations& violations) {
  const YamlMap map(node, "bodies[" + std::to_string(index) + "]",
                    {"name", "urdf", "urdf_parameter", "position", "orientation", "velocity", "angular_velocity",
                     "motion", "prescribed", "material", "self_collision", "joints"},
                    violations);
  std::string name;
  readName(map, resolver, name);
  std::vector<BodyDescription> bodies(1);
  const std::size_t violations_before = violations.count();
  readUrdf(map, folder, resolver, node, bodies, violations);
  const bool urdf_usable = violations.count() == violations_before;
  BodyDescription& root = bodies.front();
  root.name = name;
  Vector3d position = Vector3d::Zero();
  map.read<3>("position", position);
  root.X_WB.translation() = position;
  if (map.has("orientation")) {
    root.X_WB.linear() =
        readOrientation(map.get("orientation"), map.path("orientation"), violations).toRotationMatrix();
  }
  readMotion(map, bodies.size() > 1, root, violations);
  if (urdf_usable) readJoints(map, bodies, violations);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    BodyDescription& body = bodies[i];
    body.name = root.name + "/" + body.links.front().name;
    body.material = root.material;
    placeOnParent(bodies[body.joint->parent], body);
  }
  for (std::size_t i = 1; i < bodies.size(); ++i) bodies[i].joint->parent += first;
  return bodies;
}

void checkInsideTank(const BodyDescription& body, const YAML::Node& node, const TankDescription& tank,
                     Violations& violations) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : body.shapes) box.extend(bounds(shape, body.X_WB));
  if (box.isEmpty()) return;
  const double tolerance = 1e-6 * tank.cell_width;
  const auto report = [&](int axis, double excess, const std::string& what, const std::string& expected) {
    std::ostringstream text;
    text << "body \"" << body.name << "\": reaches " << excess << " m beyond " << what << " along " << "xyz"[axis]
         << ": expected " << expected;
    violations.add(node, text.str());
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double low = tank.origin[axis], high = low + tank.size[axis];
    if (tank.periodic[axis]) {
      const double excess = box.sizes()[axis] - tank.size[axis];
      if (excess > tolerance) report(axis, excess, "one period", "a body shorter than the tank");
      continue;
    }
    std::ostringstream inside;
    inside << "a body inside the tank, from " << low << " to " << high << " m";
    if (low - box.min()[axis] > tolerance) report(axis, low - box.min()[axis], "the lower wall", inside.str());
    if (box.max()[axis] - high > tolerance) report(axis, box.max()[axis] - high, "the upper wall", inside.str());
  }
}

}  // namespace monolith
