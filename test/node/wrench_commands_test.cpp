// Wrenches that users command: shifted to the centre of mass, held and summed over time, in frames that move.

#include "node/wrench_commands.h"

#include <gtest/gtest.h>
#include <tf2/buffer_core.h>

#include <cmath>

#include "node/message_conversion.h"
#include "node/reference_frames.h"
#include "node/request_error.h"

namespace monolith {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kStep = 0.1;  // s

Isometry3d somePose() {
  Isometry3d X(AngleAxisd(0.7, Vector3d(1.0, 2.0, -1.0).normalized()));
  X.translation() = Vector3d(0.3, -0.2, 0.5);
  return X;
}

RigidBody bodyAt(const Isometry3d& X_WB, const Vector3d& p_BBcm) {
  RigidBody body;
  body.name = "body";
  body.p_BBcm = p_BBcm;
  body.q_WB = Eigen::Quaterniond(X_WB.linear());
  body.p_WBcm = X_WB * p_BBcm;
  return body;
}

WrenchCommand push(double start, double end, const Vector3d& force = Vector3d::UnitX()) {
  WrenchCommand command;
  command.frame = "world";
  command.force = force;
  command.start = start;
  command.end = end;
  return command;
}

// Steps in which body 0 is pushed along x, as the sum of the forces.
std::vector<double> pushes(WrenchCommands& commands, int steps, double time_step = kStep) {
  const std::vector<RigidBody> bodies = {bodyAt(Isometry3d::Identity(), Vector3d::Zero())};
  std::vector<double> out;
  std::vector<std::string> lost;
  for (int i = 0; i < steps; ++i) {
    const auto identity = [](const std::string&) { return Isometry3d::Identity(); };
    out.push_back(commands.evaluate(time_step * i, bodies, identity, lost)[0].force.x());
    commands.commit();
  }
  EXPECT_TRUE(lost.empty());
  return out;
}

// The power of a wrench does not depend on the point that it is taken about: against any rigid motion.
TEST(AboutCentreOfMass, KeepsThePowerInEveryRigidMotion) {
  WrenchCommand command;
  command.point = Vector3d(0.1, -0.3, 0.2);
  command.force = Vector3d(3.0, -1.0, 2.0);
  command.torque = Vector3d(-0.5, 0.4, 1.5);
  const Isometry3d X_WF = somePose();
  const Vector3d p_WBcm(0.4, 0.6, -0.1);
  const Wrench wrench = aboutCentreOfMass(command, X_WF, p_WBcm);
  for (int i = 0; i < 6; ++i) {
    Vector6d motion = Vector6d::Unit(i);  // velocity of the centre of mass, angular velocity
    const Vector3d at_point = motion.head<3>() + motion.tail<3>().cross(X_WF * command.point - p_WBcm);
    const double given =
        (X_WF.linear() * command.force).dot(at_point) + (X_WF.linear() * command.torque).dot(motion.tail<3>());
    EXPECT_NEAR(wrench.force.dot(motion.head<3>()) + wrench.torque.dot(motion.tail<3>()), given, 1e-12);
  }
}

TEST(WrenchCommands, HeldOneActsUntilItsEndAndIsReplaced) {
  WrenchCommands commands(1, kStep);
  commands.hold(0, push(0.0, 0.3));
  EXPECT_EQ(pushes(commands, 5), (std::vector<double>{1, 1, 1, 0, 0}));
  commands.hold(0, push(0.0, 0.3));
  commands.hold(0, push(0.0, 0.2, 5.0 * Vector3d::UnitX()));
  EXPECT_EQ(pushes(commands, 4), (std::vector<double>{5, 5, 0, 0}));
}

TEST(WrenchCommands, AppliedOnesAddUpAndWaitForTheirStart) {
  WrenchCommands commands(1, kStep);
  commands.hold(0, push(0.0, 0.2));
  commands.apply(0, push(0.1, 0.3, 10.0 * Vector3d::UnitX()));
  commands.apply(0, push(0.2, 0.4, 100.0 * Vector3d::UnitX()));
  EXPECT_EQ(pushes(commands, 5), (std::vector<double>{1, 11, 110, 100, 0}));
}

TEST(WrenchCommands, ShorterThanAStepActsInOne) {
  WrenchCommands commands(1, kStep);
  commands.apply(0, push(0.13, 0.14));
  EXPECT_EQ(pushes(commands, 4), (std::vector<double>{0, 0, 1, 0}));
}

// Whose times ROS has rounded to nanoseconds.
TEST(WrenchCommands, OfShortStepsBeginAndEndWithTheStepsTheyMean) {
  for (const double step : {0.02, 1.0 / 3000.0, 1e-5, 1e-6, 1e-6 / 3.0, 1e-7, 1e-8}) {
    const auto inNanoseconds = [](double time) { return 1e-9 * std::round(1e9 * time); };
    WrenchCommands commands(1, step);
    commands.apply(0, push(inNanoseconds(2.0 * step), inNanoseconds(2.0 * step) + inNanoseconds(3.0 * step)));
    EXPECT_EQ(pushes(commands, 7, step), (std::vector<double>{0, 0, 1, 1, 1, 0, 0})) << step;
  }
}

TEST(WrenchCommands, EndlessOneActsUntilCleared) {
  WrenchCommands commands(1, kStep);
  commands.apply(0, push(0.0, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(pushes(commands, 3), (std::vector<double>{1, 1, 1}));
  commands.clear(0);
  EXPECT_EQ(pushes(commands, 1), (std::vector<double>{0}));
}

TEST(WrenchCommands, LostFrameEndsOnlyItsOwnCommand) {
  WrenchCommands commands(1, kStep);
  WrenchCommand lost_one = push(0.0, 1.0, 10.0 * Vector3d::UnitX());
  lost_one.frame = "gone";
  commands.hold(0, push(0.0, 1.0));
  commands.apply(0, lost_one);
  const std::vector<RigidBody> bodies = {bodyAt(Isometry3d::Identity(), Vector3d::Zero())};
  const auto frames = [](const std::string& frame) {
    if (frame == "gone") throw RequestError("frame \"gone\"");
    return Isometry3d::Identity();
  };
  std::vector<std::string> lost;
  EXPECT_EQ(commands.evaluate(0.0, bodies, frames, lost)[0].force.x(), 1.0);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_NE(lost[0].find("body"), std::string::npos);
  EXPECT_NE(lost[0].find("gone"), std::string::npos);
  EXPECT_EQ(commands.evaluate(0.1, bodies, frames, lost)[0].force.x(), 1.0);
  EXPECT_EQ(lost.size(), 1u);
}

TEST(WrenchCommands, OfAStepThatWasNotCommittedActInTheNext) {
  WrenchCommands commands(1, kStep);
  commands.hold(0, push(0.0, 0.01));
  commands.apply(0, push(0.0, 0.01, 10.0 * Vector3d::UnitX()));
  const std::vector<RigidBody> bodies = {bodyAt(Isometry3d::Identity(), Vector3d::Zero())};
  const auto identity = [](const std::string&) { return Isometry3d::Identity(); };
  std::vector<std::string> lost;
  // Also if time has gone on, as by a step in which the wrench was held back.
  for (const double time : {0.0, 0.0, 0.1}) {
    EXPECT_EQ(commands.evaluate(time, bodies, identity, lost)[0].force.x(), 11.0) << time;
  }
  commands.commit();
  EXPECT_EQ(commands.evaluate(0.2, bodies, identity, lost)[0].force.x(), 0.0);
  EXPECT_TRUE(lost.empty());
}

TEST(WrenchCommands, TooLargeForANumberIsGivenUpByNameAndTheOthersAct) {
  WrenchCommands commands(2, kStep);
  WrenchCommand far = push(0.0, 1.0, 1e200 * Vector3d::UnitX());
  far.point = 1e200 * Vector3d::UnitY();
  commands.apply(0, far);
  commands.apply(0, push(0.0, 1.0, 1.5e308 * Vector3d::UnitX()));
  commands.apply(0, push(0.0, 1.0, 1.5e308 * Vector3d::UnitX()));
  commands.apply(1, push(0.0, 1.0));
  std::vector<RigidBody> bodies(2, bodyAt(Isometry3d::Identity(), Vector3d::Zero()));
  const auto identity = [](const std::string&) { return Isometry3d::Identity(); };
  std::vector<std::string> lost;
  std::vector<Wrench> sums = commands.evaluate(0.0, bodies, identity, lost);
  EXPECT_EQ(sums[0].force.x(), 1.5e308);
  EXPECT_EQ(sums[0].torque.norm(), 0.0);
  EXPECT_EQ(sums[1].force.x(), 1.0);
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_NE(lost[0].find("\"body\""), std::string::npos) << lost[0];
  EXPECT_NE(lost[0].find("torque [0, 0, -inf]"), std::string::npos) << lost[0];
  EXPECT_NE(lost[1].find("force [1.5e+308, 0, 0]"), std::string::npos) << lost[1];
  EXPECT_NE(lost[1].find("expected a finite sum"), std::string::npos) << lost[1];
  sums = commands.evaluate(0.1, bodies, identity, lost);
  EXPECT_EQ(sums[0].force.x(), 1.5e308);
  EXPECT_EQ(lost.size(), 2u);
}

class ReferenceFramesTest : public ::testing::Test {
 protected:
  ReferenceFramesTest() {
    BodyDescription body;
    body.name = "probe";
    Isometry3d X_BL = Isometry3d::Identity();
    X_BL.translation() = Vector3d(0.0, 0.0, 0.2);
    body.links = {{"base", Isometry3d::Identity()}, {"tip", X_BL}};
    scene_.bodies = {body};
    bodies_ = {bodyAt(somePose(), Vector3d(0.01, 0.02, 0.03))};
  }

  void publish(const std::string& parent, const std::string& child, const Isometry3d& X) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = parent;
    transform.child_frame_id = child;
    transform.header.stamp = ros::Time(1.0);
    transform.transform = toTransform(X);
    buffer_.setTransform(transform, "test", true);
  }

  Scene scene_;
  std::vector<RigidBody> bodies_;
  tf2::BufferCore buffer_;
};

TEST_F(ReferenceFramesTest, OwnFramesAreWhereTheBodyIs) {
  const ReferenceFrames frames(scene_, {"world", ""}, buffer_);
  EXPECT_TRUE(frames.pose("world", bodies_).isApprox(Isometry3d::Identity()));
  EXPECT_TRUE(frames.pose("probe", bodies_).isApprox(somePose()));
  EXPECT_TRUE(frames.pose("probe/base", bodies_).isApprox(somePose()));
  EXPECT_TRUE((frames.pose("probe/tip", bodies_) * Vector3d::Zero()).isApprox(somePose() * Vector3d(0.0, 0.0, 0.2)));
}

TEST_F(ReferenceFramesTest, ForeignFrameFollowsTheBodyThatItHangsOn) {
  const ReferenceFrames frames(scene_, {"world", ""}, buffer_);
  Isometry3d X_LF(AngleAxisd(0.3, Vector3d::UnitY()));
  X_LF.translation() = Vector3d(0.05, 0.0, 0.0);
  publish("probe/tip", "bracket", X_LF);
  publish("bracket", "thruster", X_LF);
  // What tf believes of the body itself is out of date.
  publish("world", "probe", Isometry3d::Identity());
  publish("probe", "probe/tip", Isometry3d::Identity());
  const Isometry3d expected = frames.pose("probe/tip", bodies_) * X_LF * X_LF;
  EXPECT_TRUE(frames.pose("thruster", bodies_).isApprox(expected));
  bodies_[0] = bodyAt(somePose() * somePose(), bodies_[0].p_BBcm);
  const Isometry3d moved = frames.pose("probe/tip", bodies_) * X_LF * X_LF;
  EXPECT_FALSE(moved.isApprox(expected));
  EXPECT_TRUE(frames.pose("thruster", bodies_).isApprox(moved));
}

TEST_F(ReferenceFramesTest, FramesOfTheWorldsParentAreKnown) {
  const ReferenceFrames frames(scene_, {"world", ""}, buffer_);
  publish("map", "world", somePose());
  EXPECT_TRUE(frames.pose("map", bodies_).isApprox(somePose().inverse()));
  publish("map", "dock", somePose());
  EXPECT_TRUE(frames.pose("dock", bodies_).isApprox(Isometry3d::Identity()));
}

TEST_F(ReferenceFramesTest, UnknownAndUnconnectedFramesAreNamedWithTheNearest) {
  const ReferenceFrames frames(scene_, {"world", ""}, buffer_);
  publish("island", "palm", Isometry3d::Identity());
  for (const std::string frame : {"prob", "palm", "island", "/probe", "", "probe/tp"}) {
    try {
      frames.pose(frame, bodies_);
      ADD_FAILURE() << frame;
    } catch (const RequestError& error) {
      EXPECT_NE(std::string(error.what()).find("\"" + frame + "\""), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("nearest"), std::string::npos) << error.what();
    }
  }
}

TEST_F(ReferenceFramesTest, BodyMayNotHaveTheNameOfTheWorldFrame) {
  EXPECT_THROW(ReferenceFrames(scene_, FrameNames{"probe", ""}, buffer_), SceneError);
}

TEST_F(ReferenceFramesTest, OwnFramesMayNotHaveTheSameName) {
  scene_.bodies[0].links.push_back({"deck/tank", Isometry3d::Identity()});
  for (const std::string world : {"probe/tip", "probe/deck"}) {
    try {
      const ReferenceFrames frames(scene_, {world, ""}, buffer_);
      ADD_FAILURE() << world;
    } catch (const SceneError& error) {
      const std::string text = error.what();
      for (const std::string& part : {std::string("\"probe\""), "~world_frame is \"" + world + "\""}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
      }
    }
  }
}

TEST_F(ReferenceFramesTest, APrefixIsOfAllButTheWorlds) {
  const ReferenceFrames frames(scene_, {"world", "left/"}, buffer_);
  EXPECT_TRUE(frames.pose("world", bodies_).isApprox(Isometry3d::Identity()));
  EXPECT_TRUE(frames.pose("left/probe", bodies_).isApprox(somePose()));
  EXPECT_THROW(frames.pose("probe", bodies_), RequestError);
  EXPECT_EQ(frames.movedFrames(),
            (std::set<std::string>{"left/probe", "left/probe/base", "left/probe/tip", "left/world/tank"}));
  // What would be the world's own name.
  EXPECT_NO_THROW(ReferenceFrames(scene_, FrameNames{"probe", "left/"}, buffer_));
}

TEST_F(ReferenceFramesTest, TheTanksCornerIsKnown) {
  scene_.tank.origin = Vector3d(-0.5, -0.4, 0.1);
  const ReferenceFrames frames(scene_, {"world", ""}, buffer_);
  EXPECT_TRUE(frames.pose("world/tank", bodies_).translation().isApprox(scene_.tank.origin));
}

}  // namespace
}  // namespace monolith
