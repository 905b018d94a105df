// URDFs with movable joints in a scene file: names, joints and self_collision of an entry, and what is wrong with them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

const std::string kParts = R"(<inertial><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  <collision><geometry><sphere radius="0.05"/></geometry></collision>)";

// base -(shoulder, turns about y)- upper -(slide, along -z)- lower, 0.2 m below each other, and base -(spin)- wheel.
const std::string kArm = R"(<robot name="arm">
  <link name="base">)" + kParts +
                         R"(</link><link name="upper">)" + kParts + R"(</link>
  <link name="lower">)" + kParts +
                         R"(</link><link name="wheel">)" + kParts + R"(</link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 -0.2"/>
    <axis xyz="0 2 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.2"/>
    <axis xyz="0 0 -1"/><limit lower="0.01" upper="0.1" effort="1" velocity="1"/></joint>
  <joint name="spin" type="continuous"><parent link="base"/><child link="wheel"/><origin xyz="0 0.2 0"/></joint>
</robot>)";
const std::string kBall = R"(<robot name="ball"><link name="ball">)" + kParts + "</link></robot>";

class JointSection : public testing::Test {
 protected:
  JointSection() {
    folder_.write("arm.urdf", kArm);
    folder_.write("ball.urdf", kBall);
  }

  // A ball and the arm, with these further lines.
  Scene load(const std::string& lines, const std::string& contact = "") const {
    return loadScene(folder_.write("scene.yaml",
                                   "tank: {size: [1.0, 0.8, 0.8], cell_width: 0.1}\n"
                                   "bodies:\n"
                                   "  - {name: ball, urdf: ball.urdf, position: [0.4, 0, 0.3]}\n"
                                   "  - name: arm\n"
                                   "    urdf: arm.urdf\n"
                                   "    position: [0.1, 0.0, 0.7]\n" +
                                       lines + contact),
                     SceneResolver());
  }
  std::string errorOf(const std::string& lines, const std::string& contact = "") const {
    try {
      load(lines, contact);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "no error";
  }
  void expectError(const std::string& lines, const std::vector<std::string>& mentions) const {
    const std::string error = errorOf(lines);
    for (const std::string& mention : mentions) {
      EXPECT_NE(error.find(mention), std::string::npos) << "no \"" << mention << "\" in: " << error;
    }
  }

  TemporaryFolder folder_;
};

TEST_F(JointSection, BodiesBeyondJointsFollowAndAreNamedAfterTheirLinks) {
  const Scene scene = load("    material: rubber\n    motion: fixed\n");
  ASSERT_EQ(scene.bodies.size(), 5u);
  const std::vector<std::string> names = {"ball", "arm", "arm/upper", "arm/lower", "arm/wheel"};
  const std::vector<std::string> joints = {"", "", "shoulder", "slide", "spin"};
  const std::vector<int> parents = {-1, -1, 1, 2, 1};
  for (int i = 0; i < 5; ++i) {
    const BodyDescription& body = scene.bodies[i];
    EXPECT_EQ(body.name, names[i]);
    EXPECT_EQ(body.joint.has_value(), i >= 2);
    EXPECT_EQ(body.material, i >= 1 ? "rubber" : "");
    EXPECT_EQ(body.motion, i == 1 ? BodyMotion::kFixed : BodyMotion::kFree);
    EXPECT_FALSE(body.self_collision);
    if (!body.joint) continue;
    EXPECT_EQ(body.joint->name, joints[i]);
    EXPECT_EQ(body.joint->parent, parents[i]);
    EXPECT_EQ(body.joint->velocity, 0.0);
    EXPECT_EQ(body.joint->servo.stiffness, 0.0);
    EXPECT_EQ(body.joint->servo.damping, 0.0);
    EXPECT_FALSE(body.joint->prescribed);
    EXPECT_TRUE(body.velocity.isZero(0.0));
    EXPECT_TRUE(body.angular_velocity.isZero(0.0));
  }
  // Positions: 0 or the limit next to it.
  EXPECT_LT((scene.bodies[2].X_WB.translation() - Vector3d(0.1, 0, 0.5)).norm(), 1e-15);
  EXPECT_LT((scene.bodies[3].X_WB.translation() - Vector3d(0.1, 0, 0.29)).norm(), 1e-15);
  EXPECT_LT((scene.bodies[4].X_WB.translation() - Vector3d(0.1, 0.2, 0.7)).norm(), 1e-15);
}

TEST_F(JointSection, EveryValueArrives) {
  const Scene scene = load(R"(
    self_collision: true
    joints:
      slide: {position: 0.05, prescribed: {rate: 0.1, amplitude: 0.02, frequency: 3, phase: 0.25}}
      shoulder: {position: -0.5, velocity: 1.5, stiffness: 20, damping: 0.5}
)");
  for (int i = 1; i < 5; ++i) EXPECT_TRUE(scene.bodies[i].self_collision);
  EXPECT_FALSE(scene.bodies[0].self_collision);
  const JointDescription& shoulder = *scene.bodies[2].joint;
  EXPECT_EQ(shoulder.position, -0.5);
  EXPECT_EQ(shoulder.velocity, 1.5);
  EXPECT_EQ(shoulder.servo.stiffness, 20.0);
  EXPECT_EQ(shoulder.servo.damping, 0.5);
  EXPECT_FALSE(shoulder.prescribed);
  const JointDescription& slide = *scene.bodies[3].joint;
  EXPECT_EQ(slide.position, 0.05);
  ASSERT_TRUE(slide.prescribed);
  EXPECT_EQ(slide.prescribed->rate, 0.1);
  EXPECT_EQ(slide.prescribed->amplitude, 0.02);
  EXPECT_EQ(slide.prescribed->frequency, 3.0);
  EXPECT_EQ(slide.prescribed->phase, 0.25);
  EXPECT_DOUBLE_EQ(slide.velocity, 0.1 + 0.02 * 6.0 * M_PI * std::cos(0.25));
}

TEST_F(JointSection, PosesAndVelocitiesFollowFromRootAndJoints) {
  const Scene scene = load(R"(
    velocity: [0.1, 0.2, 0.3]
    angular_velocity: [0.0, 0.0, 2.0]
    orientation: {rpy: [0, 0, 1.5707963267948966]}
    joints:
      shoulder: {position: 0.5, velocity: 1.5}
      slide: {position: 0.05, velocity: -0.4}
      spin: {position: 7, velocity: 3}
)");
  // By hand: the root's y axis is -x of the world. Turned by 0.5 about it, what hangs down goes to the root's -x, the
  // world's -y.
  const double s = std::sin(0.5), c = std::cos(0.5);
  const Vector3d root(0.1, 0, 0.7), down(0.0, -s, -c), w(-1.5, 0, 2.0);
  const BodyDescription &upper = scene.bodies[2], &lower = scene.bodies[3], &wheel = scene.bodies[4];
  EXPECT_LT((upper.X_WB.translation() - (root - Vector3d(0, 0, 0.2))).norm(), 1e-15);
  EXPECT_LT((upper.X_WB.linear() * -Vector3d::UnitZ() - down).norm(), 1e-15);
  EXPECT_LT((upper.velocity - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-15);
  EXPECT_LT((upper.angular_velocity - w).norm(), 1e-15);
  const Vector3d arm = 0.25 * down;
  EXPECT_LT((lower.X_WB.translation() - (upper.X_WB.translation() + arm)).norm(), 1e-15);
  EXPECT_LT((lower.velocity - (Vector3d(0.1, 0.2, 0.3) + w.cross(arm) - 0.4 * down)).norm(), 1e-15);
  EXPECT_LT((lower.angular_velocity - w).norm(), 1e-15);
  EXPECT_LT((wheel.X_WB.translation() - Vector3d(0.1 - 0.2, 0, 0.7)).norm(), 1e-15);
  EXPECT_LT((wheel.velocity - Vector3d(0.1, 0.2 - 0.4, 0.3)).norm(), 1e-15);
  // Its axis, x by default, is the world's y.
  EXPECT_LT((wheel.angular_velocity - Vector3d(0, 3, 2)).norm(), 1e-15);
  EXPECT_LT((wheel.X_WB.linear() * Vector3d::UnitY() - Vector3d(-std::cos(7.0), 0, std::sin(7.0))).norm(), 1e-14);
}

TEST_F(JointSection, OnAPrescribedRootOnlyTheJointsVelocityIsSet) {
  const Scene scene = load(R"(
    motion: prescribed
    prescribed: {twist: [1, 0, 0, 0, 0, 0]}
    joints: {slide: {velocity: 0.5}}
)");
  EXPECT_EQ(scene.bodies[1].motion, BodyMotion::kPrescribed);
  EXPECT_TRUE(scene.bodies[2].velocity.isZero(0.0));
  EXPECT_LT((scene.bodies[3].velocity - Vector3d(0, 0, -0.5)).norm(), 1e-15);
}

TEST_F(JointSection, EachViolationNamesLineKeyValueAndExpectation) {
  struct Case {
    std::string lines;
    std::vector<std::string> mentions;
  };
  const auto joints = [](const std::string& text) { return "    joints: {" + text + "}\n"; };
  const std::string ball = "  - {name: other, urdf: ball.urdf, position: [0.3, 0.2, 0.3], ";
  const std::string path = "scene.yaml:7: bodies[1].joints";
  const std::vector<Case> cases = {
      {joints("sholder: {}"),
       {path + ".sholder: unknown joint: expected a movable one of the URDF (shoulder, slide, spin); the nearest is "
               "\"shoulder\""}},
      {joints("spin: {}, spin: {}"), {path + ".spin: given twice: expected once"}},
      {"    joints: [spin]\n", {path + ": value [spin]: expected a map", "shoulder, slide, spin"}},
      {joints("spin: 3"), {path + ".spin: value 3: expected a map"}},
      {joints("spin: {positoin: 3}"), {path + ".spin.positoin: unknown key", "\"position\""}},
      {joints("spin: {position: .inf}"), {path + ".spin.position: value .inf: expected a finite number"}},
      {joints("shoulder: {position: 1.01}"),
       {path + ".shoulder.position: value 1.01: expected a position within the joint's limits, from -1 to 1 rad"}},
      {joints("slide: {position: 0}"), {path + ".slide.position: value 0: expected", "from 0.01 to 0.1 m"}},
      {joints("slide: {position: 0, prescribed: {rate: 1}}"), {path + ".slide.position: value 0: expected"}},
      {joints("spin: {velocity: fast}"), {path + ".spin.velocity: value fast: expected a finite number"}},
      {joints("spin: {stiffness: -1}"), {path + ".spin.stiffness: value -1: expected a finite number >= 0"}},
      {joints("spin: {damping: -2}"), {path + ".spin.damping: value -2: expected a finite number >= 0"}},
      {joints("spin: {velocity: 1, prescribed: {rate: 1}}"),
       {path + ".spin.velocity: value 1: expected none beside prescribed"}},
      {joints("spin: {stiffness: 1, prescribed: {rate: 1}}"),
       {path + ".spin.stiffness: value 1: expected none beside"}},
      {joints("spin: {damping: 0, prescribed: {rate: 1}}"), {path + ".spin.damping: value 0: expected none beside"}},
      {joints("spin: {prescribed: 1}"), {path + ".spin.prescribed: value 1: expected a map"}},
      {joints("spin: {prescribed: {rat: 1}}"), {path + ".spin.prescribed.rat: unknown key", "\"rate\""}},
      {joints("spin: {prescribed: {amplitude: 1}}"),
       {path + ".spin.prescribed.amplitude: value 1: expected a frequency > 0"}},
      {joints("spin: {prescribed: {frequency: -1}}"), {path + ".spin.prescribed.frequency: value -1", ">= 0"}},
      {joints("spin: {prescribed: {rate: .nan}}"), {path + ".spin.prescribed.rate: value .nan"}},
      {joints("spin: {prescribed: {phase: x}}"), {path + ".spin.prescribed.phase: value x"}},
      {"    self_collision: 2\n", {"scene.yaml:7: bodies[1].self_collision: value 2: expected true or false"}},
      {ball + "self_collision: false}\n",
       {"scene.yaml:7: bodies[2].self_collision: value false: expected none for a URDF without movable joints"}},
      {ball + "joints: {}}\n", {"scene.yaml:7: bodies[2].joints: value {}: expected none for a URDF without"}},
      {"    motion: prescribed\n    prescribed: {twist: [1, 0, 0, 0, 0, 0], in_place: true}\n",
       {"scene.yaml:8: bodies[1].prescribed.in_place: value true: expected false for a URDF with movable joints"}},
      // Every body has to be in the tank.
      {joints("shoulder: {position: 0.2}, slide: {position: 0.1}") + "    orientation: {rpy: [1.2, 0, 0]}\n",
       {"scene.yaml:4: body \"arm/lower\": reaches 0.110446 m beyond the upper wall along y"}},
      {"  - {name: arm, urdf: arm.urdf, position: [0.1, 0, 0.7]}\n",
       {"bodies[2].name: value arm: expected a name of its own, bodies[1] has it already"}},
      {"  - {name: arm/upper, urdf: ball.urdf}\n", {"bodies[2].name: value arm/upper: expected a letter followed by"}},
  };
  for (const Case& c : cases) expectError(c.lines, c.mentions);
}

TEST_F(JointSection, SeveralViolationsAreReportedTogether) {
  const std::string error = errorOf("    joints: {a: {}, b: {}, spin: {velocity: x, position: y}}\n");
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 3) << error;
}

TEST_F(JointSection, AnUnusableUrdfHasNoSayAboutJoints) {
  folder_.write("bad.urdf", "<robot name='r'><link name='a'/></robot>");
  const std::string error =
      errorOf("  - {name: bad, urdf: bad.urdf, self_collision: true, joints: {a: {position: 1}}}\n");
  EXPECT_NE(error.find("no <collision>"), std::string::npos) << error;
  EXPECT_EQ(error.find("bodies[2].joints"), std::string::npos) << error;
  EXPECT_EQ(error.find("self_collision"), std::string::npos) << error;
}

TEST_F(JointSection, ContactPairsNameBodiesBeyondJoints) {
  const auto between = [](const std::string& names) {
    return "contact: {pairs: [{between: [" + names + "], friction: 0.5}]}\n";
  };
  const Scene scene = load("", between("arm/lower, ball"));
  ASSERT_EQ(scene.contact.pairs.size(), 1u);
  EXPECT_EQ(scene.contact.pairs[0].a, "arm/lower");
  EXPECT_EQ(errorOf("", between("arm/lower, arm/wheel")), "no error");
  EXPECT_NE(errorOf("", between("arm/lover, ball")).find("the nearest to arm/lover is arm/lower"), std::string::npos);
  EXPECT_NE(errorOf("", between("arm/lower, arm/lower")).find("two that can touch"), std::string::npos);
}

TEST_F(JointSection, JointedBodiesMayBeAnywhereInAPeriodicTank) {
  const std::string yaml =
      "tank: {size: [1.0, 0.8, 0.8], cell_width: 0.1, periodic: [true, true, true]}\n"
      "bodies: [{name: arm, urdf: arm.urdf, position: [5, 5, 5]}]\n";
  EXPECT_EQ(loadScene(folder_.write("periodic.yaml", yaml), SceneResolver()).bodies.size(), 4u);
}

}  // namespace
}  // namespace monolith
