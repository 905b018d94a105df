// The simulation with its wrenches, as topics and services act on it.

#include "node/tank_control.h"

#include <gtest/gtest.h>
#include <tf2/buffer_core.h>

#include "node/request_error.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

class TankControlTest : public ::testing::Test {
 protected:
  static Scene scene() {
    Scene scene;
    scene.source = "test";
    scene.tank.size = Eigen::Vector3d::Constant(0.16);
    scene.tank.cell_width = 0.02;
    scene.solver.threads = 1;
    scene.liquid.fill_level = 0.08;
    scene.liquid.dynamic_viscosity = 1.0;
    scene.bodies.push_back(sphereBody("ball", 0.02, 1000.0, {0.08, 0.08, 0.05}));
    return scene;
  }

  static WrenchCommand push(double force, double end) {
    WrenchCommand command;
    command.force.x() = force;
    command.end = end;
    return command;
  }

  using Kind = WrenchCommands::Kind;

  // Why a wrench is refused; "" if it isn't.
  std::string refusal(Kind kind, const WrenchCommand& command) const {
    try {
      control_.requireFinite(kind, 0, command);
    } catch (const RequestError& error) {
      return error.what();
    }
    return "";
  }

  tf2::BufferCore transforms_;
  TankControl control_{scene(), {"world", ""}, transforms_};
  std::vector<std::string> lost_;
};

TEST_F(TankControlTest, AShortWrenchIsNotLostWithAStepThatFails) {
  control_.wrenches().apply(0, push(0.02, 0.001));
  control_.wrenches().hold(0, push(1e305, 1.0));
  ASSERT_FALSE(control_.step(lost_).committed());
  control_.wrenches().hold(0, push(0.0, 1.0));
  ASSERT_TRUE(control_.step(lost_).committed());
  const double pushed = control_.simulation().bodyStates()[0].velocity.x();
  EXPECT_GT(pushed, 1e-3);
  // In one step only.
  ASSERT_TRUE(control_.step(lost_).committed());
  EXPECT_LT(control_.simulation().bodyStates()[0].velocity.x(), pushed);
  EXPECT_TRUE(lost_.empty());
}

TEST_F(TankControlTest, AWrenchThatIsTooLargeAboutTheCentreOfMassIsRefused) {
  WrenchCommand command = push(1e308, 1.0);
  EXPECT_EQ(refusal(Kind::kApplied, command), "");
  command.point.y() = 1e308;
  for (const Kind kind : {Kind::kApplied, Kind::kHeld}) {
    const std::string text = refusal(kind, command);
    for (const char* part : {"wrench: ", "\"ball\"", "torque [", "-inf", "expected finite"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
    }
  }
}

TEST_F(TankControlTest, WrenchesWhoseSumIsTooLargeAreRefused) {
  const WrenchCommand command = push(1e308, 1.0);
  control_.wrenches().hold(0, command);
  const std::string text = refusal(Kind::kApplied, command);
  for (const char* part : {"wrench: ", "\"ball\"", "force [1e+308, 0, 0] N", "expected a finite sum"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }
  // Nothing acts beside what is held instead, or against it.
  EXPECT_EQ(refusal(Kind::kHeld, command), "");
  EXPECT_EQ(refusal(Kind::kApplied, push(-1e308, 1.0)), "");
  control_.wrenches().clear();
  control_.wrenches().apply(0, command);
  EXPECT_NE(refusal(Kind::kApplied, command), "");
  EXPECT_NE(refusal(Kind::kHeld, command), "");
  // What acts later does so only if it can then.
  WrenchCommand later = command;
  later.start = 1.0;
  control_.wrenches().clear();
  control_.wrenches().apply(0, later);
  EXPECT_EQ(refusal(Kind::kApplied, command), "");
  EXPECT_NE(refusal(Kind::kApplied, later), "");
}

// Two links in a dry tank, the second of which slides with a command that a step which fails does not use up.
TEST(TankControlJoints, AShortEffortIsNotLostWithAStepThatFailsNorKeptByAReset) {
  Scene scene;
  scene.source = "test";
  scene.tank.cell_width = 0.1;
  scene.gravity.setZero();
  scene.solver.threads = 1;
  scene.bodies = {sphereBody("cart", 0.1, 1000.0, {0.5, 0.5, 0.5})};
  scene.bodies[0].motion = BodyMotion::kFixed;
  JointDescription rail;
  rail.name = "rail";
  rail.type = JointType::kPrismatic;
  rail.X_PJ.translation() = Eigen::Vector3d(0.0, 0.3, 0.0);
  hangOn(scene.bodies, 0, sphereBody("bob", 0.1, 1000.0, Eigen::Vector3d::Zero()), rail);
  const double mass = scene.bodies[1].mass;
  const tf2::BufferCore transforms;
  TankControl control(scene, {"world", ""}, transforms);
  std::vector<std::string> lost;
  const auto velocity = [&] { return control.simulation().jointStates()[0].velocity; };
  control.joints().holdEffort(1, 2.0 * mass, 0.001);
  WrenchCommand push;
  push.force.x() = 1e305;
  push.end = 1.0;
  control.wrenches().hold(1, push);
  ASSERT_FALSE(control.step(lost).committed());
  control.wrenches().clear();
  ASSERT_TRUE(control.step(lost).committed());
  EXPECT_NEAR(velocity(), 2.0 * scene.time_step, 1e-6);
  ASSERT_TRUE(control.step(lost).committed());
  EXPECT_NEAR(velocity(), 2.0 * scene.time_step, 1e-6);
  control.joints().holdEffort(1, 2.0 * mass, 1.0);
  control.reset();
  ASSERT_TRUE(control.step(lost).committed());
  EXPECT_EQ(velocity(), 0.0);
}

}  // namespace
}  // namespace monolith
