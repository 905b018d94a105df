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

  tf2::BufferCore transforms_;
  TankControl control_{scene(), "world", transforms_};
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
  EXPECT_NO_THROW(control_.requireFinite(0, command, Eigen::Isometry3d::Identity()));
  command.point.y() = 1e308;
  try {
    control_.requireFinite(0, command, Eigen::Isometry3d::Identity());
    FAIL();
  } catch (const RequestError& error) {
    const std::string text = error.what();
    for (const char* part : {"wrench: ", "\"ball\"", "torque [", "-inf", "expected finite"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
    }
  }
}

}  // namespace
}  // namespace monolith
