// What is commanded of joints: which part for how long.

#include "node/joint_commands.h"

#include <gtest/gtest.h>

#include "scene/solid_body.h"

namespace monolith {
namespace {

constexpr double kStep = 0.1;  // s

// A body, and two that hang on it in a row.
Scene chain() {
  Scene scene;
  scene.time_step = kStep;
  scene.bodies = {sphereBody("root", 0.1, 500.0, Eigen::Vector3d::Zero())};
  JointDescription joint;
  joint.position = 0.7;
  hangOn(scene.bodies, 0, sphereBody("upper", 0.1, 500.0, Eigen::Vector3d::Zero()), joint);
  joint.position = -0.2;
  hangOn(scene.bodies, 1, sphereBody("lower", 0.1, 500.0, Eigen::Vector3d::Zero()), joint);
  return scene;
}

class JointCommandsTest : public ::testing::Test {
 protected:
  // Of body 2 in steps to come, all of which are committed.
  std::vector<JointCommand> follow(int steps) {
    std::vector<JointCommand> out;
    for (int i = 0; i < steps; ++i) {
      out.push_back(commands_.evaluate(kStep * step_++)[2]);
      commands_.commit();
    }
    return out;
  }

  static std::vector<double> efforts(const std::vector<JointCommand>& commands) {
    std::vector<double> out;
    for (const JointCommand& command : commands) out.push_back(command.effort);
    return out;
  }

  JointCommands commands_{chain()};
  int step_ = 0;
};

TEST_F(JointCommandsTest, AtFirstJointsAreToStayWhereTheyStart) {
  const std::vector<JointCommand> commands = commands_.evaluate(0.0);
  ASSERT_EQ(commands.size(), 3u);
  EXPECT_EQ(commands[1].position, 0.7);
  EXPECT_EQ(commands[2].position, -0.2);
  for (const JointCommand& command : commands) {
    EXPECT_EQ(command.effort, 0.0);
    EXPECT_EQ(command.velocity, 0.0);
  }
}

TEST_F(JointCommandsTest, EffortAndVelocityEndByThemselvesAndThePositionStays) {
  commands_.holdEffort(2, 3.0, 0.3);
  commands_.holdVelocity(2, -1.0, 0.2);
  commands_.holdPosition(2, 0.5);
  const std::vector<JointCommand> commands = follow(5);
  EXPECT_EQ(efforts(commands), (std::vector<double>{3, 3, 3, 0, 0}));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(commands[i].velocity, i < 2 ? -1.0 : 0.0);
    EXPECT_EQ(commands[i].position, 0.5);
  }
  EXPECT_EQ(commands_.evaluate(0.0)[1].position, 0.7) << "another joint's";
}

TEST_F(JointCommandsTest, WhatIsGivenTakesThePlaceOfItsOwnKindOnly) {
  commands_.holdEffort(2, 3.0, 0.4);
  follow(1);
  commands_.holdVelocity(2, 1.0, 0.2);
  commands_.holdPosition(2, 0.1);
  EXPECT_EQ(follow(1)[0].effort, 3.0);
  commands_.holdEffort(2, -5.0, 0.3);
  EXPECT_EQ(efforts(follow(3)), (std::vector<double>{-5, 0, 0}));
}

TEST_F(JointCommandsTest, ShorterThanAStepActsInOne) {
  commands_.holdEffort(2, 3.0, 0.001);
  EXPECT_EQ(efforts(follow(3)), (std::vector<double>{3, 0, 0}));
}

TEST_F(JointCommandsTest, OfAStepThatWasNotCommittedActInTheNext) {
  commands_.holdEffort(2, 3.0, 0.01);
  for (const double time : {0.0, 0.0, 0.1}) EXPECT_EQ(commands_.evaluate(time)[2].effort, 3.0) << time;
  commands_.commit();
  EXPECT_EQ(commands_.evaluate(0.2)[2].effort, 0.0);
}

TEST_F(JointCommandsTest, ClearedTheyAreAsAtFirst) {
  commands_.holdEffort(2, 3.0, 1.0);
  commands_.holdVelocity(2, 3.0, 1.0);
  commands_.holdPosition(2, 3.0);
  follow(1);
  commands_.clear();
  const JointCommand command = follow(1)[0];
  EXPECT_EQ(command.effort, 0.0);
  EXPECT_EQ(command.velocity, 0.0);
  EXPECT_EQ(command.position, -0.2);
}

}  // namespace
}  // namespace monolith
