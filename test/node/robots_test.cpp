// Robots among the bodies of a scene: which there are, their frames, and what is said of joints and numbers that do not
// fit.

#include "node/robots.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "node/request_error.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

BodyDescription body(const std::string& name, const std::vector<std::string>& links) {
  BodyDescription out = sphereBody(name, 0.1, 500.0, Vector3d::Zero());
  out.links.clear();
  for (const std::string& link : links) {
    out.links.push_back({link, Eigen::Isometry3d(Eigen::Translation3d(0.1 * out.links.size(), 0.0, 0.0))});
  }
  return out;
}

JointDescription joint(const std::string& name) {
  JointDescription out;
  out.name = name;
  return out;
}

// Two robots, the first with a branch, around a body that is none.
Scene robotsAndABall() {
  Scene scene;
  scene.bodies = {body("arm", {"base", "mount"})};
  hangOn(scene.bodies, 0, body("upper", {"upper", "lamp"}), joint("shoulder"));
  hangOn(scene.bodies, 1, body("left", {"left"}), joint("left_finger"));
  hangOn(scene.bodies, 1, body("right", {"right"}), joint("right_finger"));
  scene.bodies.back().joint->prescribed.emplace();
  scene.bodies.push_back(body("ball", {"core"}));
  scene.bodies.push_back(body("door", {"frame"}));
  hangOn(scene.bodies, 5, body("leaf", {"leaf"}), joint("hinge"));
  return scene;
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const RequestError& error) {
    return error.what();
  }
  return "";
}

void expectParts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

TEST(Robots, AreRootsThatSomethingHangsOn) {
  const Scene scene = robotsAndABall();
  const std::vector<Robot> robots = findRobots(scene);
  ASSERT_EQ(robots.size(), 2u);
  EXPECT_EQ(robots[0].name, "arm");
  EXPECT_EQ(robots[0].jointed, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(robots[1].name, "door");
  EXPECT_EQ(robots[1].jointed, (std::vector<int>{6}));
  for (const auto& [b, root] : std::vector<std::pair<int, int>>{{0, 0}, {1, 0}, {3, 0}, {4, 4}, {6, 5}}) {
    EXPECT_EQ(rootOf(scene, b), root);
  }
  EXPECT_TRUE(findRobots(Scene()).empty());
}

TEST(Robots, WhatHangsByFreeJointsOrOnAFreeRootCanBeMoved) {
  Scene scene = robotsAndABall();
  const auto movable = [&] {
    std::vector<int> out;
    for (int b = 0; b < 7; ++b) {
      if (canBeMoved(scene, b)) out.push_back(b);
    }
    return out;
  };
  EXPECT_EQ(movable(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
  for (const int root : {0, 4, 5}) scene.bodies[root].motion = BodyMotion::kFixed;
  EXPECT_EQ(movable(), (std::vector<int>{1, 2, 3, 6}));
  scene.bodies[1].joint->prescribed.emplace();
  EXPECT_EQ(movable(), (std::vector<int>{2, 6})) << "the right finger is prescribed too";
}

TEST(Robots, FramesOfLinksBeginWithTheRobotsName) {
  const Scene scene = robotsAndABall();
  const auto frames = [&](int b) {
    std::vector<std::string> out;
    for (const NamedFrame& frame : linkFrames(scene, b, {"world", "left/"})) out.push_back(frame.frame);
    return out;
  };
  EXPECT_EQ(frames(0), (std::vector<std::string>{"left/arm/base", "left/arm/mount"}));
  // Its first link has the body's own frame.
  EXPECT_EQ(frames(1), (std::vector<std::string>{"left/arm/lamp"}));
  EXPECT_TRUE(frames(2).empty());
  EXPECT_EQ(frames(4), (std::vector<std::string>{"left/ball/core"}));
  const NamedFrame lamp = linkFrames(scene, 1, FrameNames())[0];
  EXPECT_EQ(lamp.link, "lamp");
  EXPECT_EQ(lamp.X_BL.translation(), Vector3d(0.1, 0.0, 0.0));
}

TEST(FindJoints, GivesTheBodiesBeyondThem) {
  const Scene scene = robotsAndABall();
  const std::vector<Robot> robots = findRobots(scene);
  EXPECT_EQ(findJoints(scene, robots[0], {"left_finger", "shoulder"}, "name"), (std::vector<int>{2, 1}));
  EXPECT_EQ(findJoints(scene, robots[1], {"hinge"}, "name"), (std::vector<int>{6}));
}

TEST(FindJoints, RefusesByFieldAndValue) {
  const Scene scene = robotsAndABall();
  const std::vector<Robot> robots = findRobots(scene);
  const auto refused = [&](const std::vector<std::string>& names) {
    return refusal([&] { findJoints(scene, robots[0], names, "name"); });
  };
  expectParts(refused({}), {"name: value []", "joints of \"arm\"", "\"shoulder\""});
  expectParts(refused({"shoulder", "left_fingr"}),
              {"name[1]: value \"left_fingr\"", "a movable joint of \"arm\"", "the nearest is \"left_finger\""});
  expectParts(refused({"hinge"}), {"name[0]: value \"hinge\"", "of \"arm\""});  // another robot's
  expectParts(refused({"right_finger"}), {"name[0]: value \"right_finger\"", "as the scene prescribes", "expected"});
  expectParts(refused({"shoulder", "left_finger", "shoulder"}), {"name[2]: value \"shoulder\"", "each joint once"});
}

TEST(RequireNumbers, RefusesByFieldAndValue) {
  const std::vector<std::string> names = {"shoulder", "hinge"};
  EXPECT_EQ(refusal([&] { requireNumbers({1.0, -2.0}, names, "effort"); }), "");
  expectParts(refusal([&] { requireNumbers({1.0}, names, "effort"); }), {"effort: 1 values: expected 2"});
  expectParts(refusal([&] { requireNumbers({1.0, 2.0, 3.0}, names, "effort"); }), {"effort: 3 values: expected 2"});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expectParts(refusal([&] {
                  requireNumbers({1.0, bad}, names, "effort");
                }),
                {"effort[1]: value", "\"hinge\"", "expected a finite number"});
  }
}

}  // namespace
}  // namespace monolith
