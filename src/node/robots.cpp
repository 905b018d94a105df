#include "node/robots.h"

#include <algorithm>
#include <cmath>

#include "node/request_error.h"
#include "scene/nearest_word.h"

namespace monolith {

int rootOf(const Scene& scene, int body) {
  while (scene.bodies[body].joint) body = scene.bodies[body].joint->parent;
  return body;
}

bool canBeMoved(const Scene& scene, int body) {
  for (; scene.bodies[body].joint; body = scene.bodies[body].joint->parent) {
    if (!scene.bodies[body].joint->prescribed) return true;
  }
  return scene.bodies[body].motion == BodyMotion::kFree;
}

std::vector<Robot> findRobots(const Scene& scene) {
  std::vector<Robot> all(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    all[b].name = scene.bodies[b].name;
    if (scene.bodies[b].joint) all[rootOf(scene, static_cast<int>(b))].jointed.push_back(static_cast<int>(b));
  }
  all.erase(std::remove_if(all.begin(), all.end(), [](const Robot& robot) { return robot.jointed.empty(); }),
            all.end());
  return all;
}

std::vector<NamedFrame> linkFrames(const Scene& scene, int body, const FrameNames& names) {
  const std::string& root = scene.bodies[rootOf(scene, body)].name;
  std::vector<NamedFrame> frames;
  for (const LinkFrame& link : scene.bodies[body].links) {
    const std::string frame = names.link(root, link.name);
    if (frame != names.body(scene.bodies[body].name)) frames.push_back({link.name, frame, link.X_BL});
  }
  return frames;
}

std::vector<int> findJoints(const Scene& scene, const Robot& robot, const std::vector<std::string>& names,
                            const std::string& field) {
  std::vector<std::string> known;
  for (const int body : robot.jointed) known.push_back(scene.bodies[body].joint->name);
  if (names.empty()) {
    throw RequestError(field + ": value []: expected names of joints of \"" + robot.name + "\", such as \"" + known[0] +
                       "\"");
  }
  std::vector<int> bodies;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string given = field + "[" + std::to_string(i) + "]: value \"" + names[i] + "\"";
    const auto at = std::find(known.begin(), known.end(), names[i]);
    if (at == known.end()) {
      throw RequestError(given + ": expected a movable joint of \"" + robot.name + "\", the nearest is \"" +
                         nearestWord(names[i], known) + "\"");
    }
    const int body = robot.jointed[at - known.begin()];
    if (scene.bodies[body].joint->prescribed) {
      throw RequestError(given + ": this joint moves as the scene prescribes: expected one that is free to move");
    }
    if (std::find(bodies.begin(), bodies.end(), body) != bodies.end()) {
      throw RequestError(given + ": named before: expected each joint once");
    }
    bodies.push_back(body);
  }
  return bodies;
}

void requireNumbers(const std::vector<double>& values, const std::vector<std::string>& names,
                    const std::string& field) {
  if (values.size() != names.size()) {
    throw RequestError(field + ": " + std::to_string(values.size()) + " values: expected " +
                       std::to_string(names.size()) + ", one for each name");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw RequestError(field + "[" + std::to_string(i) + "]: value " + std::to_string(values[i]) + " for \"" +
                       names[i] + "\": expected a finite number");
  }
}

}  // namespace monolith
