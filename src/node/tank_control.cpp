#include "node/tank_control.h"

#include <sstream>

#include "node/request_error.h"
#include "scene/nearest_word.h"

namespace monolith {
namespace {

std::string nearest(const std::string& name, const std::vector<std::string>& known) {
  return known.empty() ? "but the scene has none" : "the nearest is \"" + nearestWord(name, known) + "\"";
}

std::string movedBy(const BodyDescription& body) {
  return body.motion == BodyMotion::kFixed ? "fixed" : "moved as the scene prescribes";
}

}  // namespace

TankControl::TankControl(const Scene& scene, const FrameNames& names, const tf2::BufferCore& transforms)
    : simulation_(scene),
      frames_(scene, names, transforms),
      wrenches_(static_cast<int>(scene.bodies.size()), scene.time_step),
      joints_(scene),
      robots_(findRobots(scene)) {}

int TankControl::findBody(const std::string& name, const std::string& field) const {
  std::vector<std::string> names;
  for (const BodyDescription& body : simulation_.scene().bodies) {
    if (body.name == name) return static_cast<int>(names.size());
    names.push_back(body.name);
  }
  throw RequestError(field + ": value \"" + name + "\": expected a body of the scene, " + nearest(name, names));
}

const Robot& TankControl::findRobot(const std::string& name, const std::string& field) const {
  std::vector<std::string> names;
  for (const Robot& robot : robots_) {
    if (robot.name == name) return robot;
    names.push_back(robot.name);
  }
  throw RequestError(field + ": value \"" + name + "\": expected a robot, a body that others hang on by joints, " +
                     nearest(name, names));
}

void TankControl::requireFree(int body, const std::string& field) const {
  const BodyDescription& description = simulation_.scene().bodies[body];
  if (description.motion == BodyMotion::kFree) return;
  throw RequestError(field + ": value \"" + description.name + "\": this body is " + movedBy(description) +
                     ": expected one with motion: free");
}

void TankControl::requireMovable(int body, const std::string& field) const {
  if (canBeMoved(simulation_.scene(), body)) return;
  const BodyDescription& description = simulation_.scene().bodies[body];
  throw RequestError(field + ": value \"" + description.name + "\": this body is " + movedBy(description) +
                     ": expected one with motion: free, or beyond a joint that is not prescribed");
}

Eigen::Isometry3d TankControl::framePose(const std::string& frame, const std::string& field) const {
  try {
    return framePoses()(frame);
  } catch (const RequestError& error) {
    throw RequestError(field + ": " + error.what());
  }
}

void TankControl::requireFinite(WrenchCommands::Kind kind, int body, const WrenchCommand& command) const {
  const RigidBody& on = simulation_.bodies()[body];
  try {
    wrenches_.requireFinite(kind, body, command, on, framePoses());
  } catch (const RequestError& error) {
    throw RequestError("wrench: on \"" + on.name + "\" " + error.what());
  }
}

WrenchCommands::FramePose TankControl::framePoses() const {
  return [this](const std::string& frame) {
    return frames_.pose(frame.empty() ? frames_.worldFrame() : frame, simulation_.bodies());
  };
}

void TankControl::requireInRange(const std::vector<int>& bodies, const std::vector<double>& positions,
                                 const std::string& field) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const JointDescription& joint = *simulation_.scene().bodies[bodies[i]].joint;
    if (positions[i] >= joint.lower && positions[i] <= joint.upper) continue;
    std::ostringstream text;
    text << field << "[" << i << "]: value " << positions[i] << " for \"" << joint.name << "\": expected "
         << (joint.type == JointType::kRevolute ? "an angle in rad" : "a length in m") << " from " << joint.lower
         << " to " << joint.upper;
    throw RequestError(text.str());
  }
}

StepReport TankControl::step(std::vector<std::string>& lost) {
  const std::vector<Wrench> wrenches = wrenches_.evaluate(simulation_.time(), simulation_.bodies(), framePoses(), lost);
  for (std::size_t b = 0; b < wrenches.size(); ++b) simulation_.setWrench(static_cast<int>(b), wrenches[b]);
  const std::vector<JointCommand> commands = joints_.evaluate(simulation_.time());
  for (const Robot& robot : robots_) {
    for (const int body : robot.jointed) {
      if (!simulation_.scene().bodies[body].joint->prescribed) simulation_.setJointCommand(body, commands[body]);
    }
  }
  const StepReport report = simulation_.step();
  if (report.committed()) {
    wrenches_.commit();
    joints_.commit();
  }
  return report;
}

void TankControl::reset() {
  wrenches_.clear();
  joints_.clear();
  simulation_.reset();
}

}  // namespace monolith
