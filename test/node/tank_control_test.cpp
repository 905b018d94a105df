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

}  // namespace
}  // namespace monolith
