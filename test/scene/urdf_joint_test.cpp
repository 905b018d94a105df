// URDF texts -> several bodies joined by movable joints, and what is refused of these.

#include "scene/urdf_joint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "scene/urdf_body.h"

namespace monolith {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::string kInertial =
    R"(<inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
const std::string kBall = R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>)";
const std::string kLimit = R"(<limit lower="-0.5" upper="1.5" effort="3" velocity="1"/>)";

std::string robot(const std::string& content) { return "<robot name=\"r\">" + content + "</robot>"; }
std::string link(const std::string& name, const std::string& content = kInertial + kBall) {
  return "<link name=\"" + name + "\">" + content + "</link>";
}
std::string joint(const std::string& parent, const std::string& child, const std::string& type,
                  const std::string& content = "") {
  return "<joint name=\"to_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
         child + "\"/>" + content + "</joint>";
}
// Two links, a joint between them.
std::string pair(const std::string& type, const std::string& content) {
  return robot(link("a") + link("b") + joint("a", "b", type, content));
}

struct Result {
  std::vector<BodyDescription> bodies;
  std::string errors;
};

Result read(const std::string& xml) {
  Result result;
  for (const std::string& line : readUrdfBodies({"test.urdf", "", xml}, SceneResolver(), result.bodies)) {
    result.errors += line + "\n";
  }
  return result;
}

JointDescription jointOf(const std::string& type, const std::string& content) {
  const Result result = read(pair(type, content));
  EXPECT_EQ(result.errors, "");
  return result.bodies.size() == 2 ? result.bodies[1].joint.value() : JointDescription();
}

TEST(UrdfJoint, BodiesFollowTheOnesTheyHangOn) {
  // Parents come after children in the text and in the alphabet.
  const std::string fixed = "fixed", turning = "continuous";
  const Result result =
      read(robot(link("leaf") + link("twig") + link("branch") + link("zweig") + link("knot") + link("trunk") +
                 joint("zweig", "leaf", turning) + joint("zweig", "twig", turning) + joint("knot", "zweig", turning) +
                 joint("trunk", "knot", fixed) + joint("trunk", "branch", turning)));
  ASSERT_EQ(result.errors, "");
  ASSERT_EQ(result.bodies.size(), 5u);
  const auto& bodies = result.bodies;
  const auto at = [&](const std::string& first_link) {
    const auto found = std::find_if(bodies.begin(), bodies.end(),
                                    [&](const BodyDescription& b) { return b.links.front().name == first_link; });
    EXPECT_NE(found, bodies.end()) << first_link;
    return static_cast<int>(found - bodies.begin());
  };
  EXPECT_EQ(at("trunk"), 0);
  EXPECT_FALSE(bodies[0].joint);
  ASSERT_EQ(bodies[0].links.size(), 2u);
  EXPECT_EQ(bodies[0].links[1].name, "knot");
  EXPECT_EQ(bodies[0].mass, 4.0);
  for (const auto& [child, parent] : {std::pair("zweig", "trunk"), std::pair("branch", "trunk"),
                                      std::pair("leaf", "zweig"), std::pair("twig", "zweig")}) {
    const BodyDescription& body = bodies[at(child)];
    ASSERT_TRUE(body.joint);
    EXPECT_EQ(body.joint->name, std::string("to_") + child);
    EXPECT_EQ(body.joint->parent, at(parent)) << child;
    EXPECT_LT(body.joint->parent, at(child));
    EXPECT_EQ(body.links.size(), 1u);
    EXPECT_EQ(body.shapes.size(), 1u);
    EXPECT_EQ(body.mass, 2.0);
    EXPECT_EQ(body.motion, BodyMotion::kFree);
  }
  for (const BodyDescription& body : bodies) {
    EXPECT_EQ(body.source, "test.urdf");
    EXPECT_EQ(body.urdf_xml, bodies[0].urdf_xml);
    EXPECT_NE(body.urdf_xml, "");
  }
}

TEST(UrdfJoint, FramesGoThroughFixedLinksOnBothSides) {
  // a -fixed- b -revolute- c -fixed- d: b turned by 90 degrees about z, the joint by 90 about x.
  const std::string quarter_z = R"(<origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>)";
  const std::string quarter_x = R"(<origin xyz="4 5 6" rpy="1.5707963267948966 0 0"/>)";
  const Result result = read(robot(link("a") + link("b") + link("c") + link("d") + joint("a", "b", "fixed", quarter_z) +
                                   joint("b", "c", "revolute", quarter_x + R"(<axis xyz="0 0 1"/>)" + kLimit) +
                                   joint("c", "d", "fixed", R"(<origin xyz="0 0 7" rpy="0 0 0"/>)")));
  ASSERT_EQ(result.errors, "");
  ASSERT_EQ(result.bodies.size(), 2u);
  const JointDescription& joint = *result.bodies[1].joint;
  // By hand: x of b is y of a, y of b is -x of a.
  EXPECT_LT((joint.X_PJ.translation() - Vector3d(1 - 5, 2 + 4, 3 + 6)).norm(), 1e-12);
  Matrix3d R;    // columns: axes of c in a
  R << 0, 0, 1,  //
      1, 0, 0,   //
      0, 1, 0;
  EXPECT_LT((joint.X_PJ.linear() - R).norm(), 1e-12);
  EXPECT_EQ(joint.axis, Vector3d::UnitZ());  // in the child's frame
  const BodyDescription& beyond = result.bodies[1];
  ASSERT_EQ(beyond.links.size(), 2u);
  EXPECT_EQ(beyond.links[0].name, "c");
  EXPECT_TRUE(beyond.links[0].X_BL.matrix().isIdentity(0.0));
  EXPECT_EQ(beyond.links[1].name, "d");
  EXPECT_LT((beyond.links[1].X_BL.translation() - Vector3d(0, 0, 7)).norm(), 1e-12);
  ASSERT_EQ(beyond.shapes.size(), 2u);
  EXPECT_EQ(beyond.shapes[1].name, "d/collision[0]");
  EXPECT_LT((beyond.shapes[1].X_BG.translation() - Vector3d(0, 0, 7)).norm(), 1e-12);
  // Its own mass only, about its own centre: two of 2 kg and 7 m apart.
  EXPECT_DOUBLE_EQ(beyond.mass, 4.0);
  EXPECT_LT((beyond.p_BBcm - Vector3d(0, 0, 3.5)).norm(), 1e-12);
  const double across = 2.0 + 2.0 * 2.0 * 3.5 * 3.5;
  EXPECT_LT((beyond.inertia_Bcm - Matrix3d(Vector3d(across, across, 2.0).asDiagonal())).norm(), 1e-12);
}

TEST(UrdfJoint, AxisIsNormalisedAndAlongXUnlessGiven) {
  EXPECT_EQ(jointOf("continuous", "").axis, Vector3d::UnitX());
  EXPECT_LT((jointOf("continuous", R"(<axis xyz="0 3 -4"/>)").axis - Vector3d(0, 0.6, -0.8)).norm(), 1e-15);
  EXPECT_LT((jointOf("continuous", R"(<axis xyz="0 3e-200 -4e-200"/>)").axis - Vector3d(0, 0.6, -0.8)).norm(), 1e-15);
  EXPECT_LT((jointOf("continuous", R"(<axis xyz="3e200 0 4e200"/>)").axis - Vector3d(0.6, 0, 0.8)).norm(), 1e-15);
}

TEST(UrdfJoint, TypesAndLimitsAreRead) {
  const double endless = std::numeric_limits<double>::infinity();
  const JointDescription revolute = jointOf("revolute", kLimit);
  EXPECT_EQ(revolute.type, JointType::kRevolute);
  EXPECT_EQ(revolute.lower, -0.5);
  EXPECT_EQ(revolute.upper, 1.5);
  EXPECT_EQ(revolute.most_effort, 3.0);
  EXPECT_FALSE(revolute.prescribed);
  const JointDescription prismatic = jointOf("prismatic", kLimit);
  EXPECT_EQ(prismatic.type, JointType::kPrismatic);
  EXPECT_EQ(prismatic.lower, -0.5);
  EXPECT_EQ(prismatic.upper, 1.5);
  const JointDescription free = jointOf("continuous", "");
  EXPECT_EQ(free.type, JointType::kRevolute);
  EXPECT_EQ(free.lower, -endless);
  EXPECT_EQ(free.upper, endless);
  EXPECT_EQ(free.most_effort, endless);
  // Of a continuous joint only the effort is limited.
  const JointDescription weak = jointOf("continuous", kLimit);
  EXPECT_EQ(weak.lower, -endless);
  EXPECT_EQ(weak.upper, endless);
  EXPECT_EQ(weak.most_effort, 3.0);
}

TEST(UrdfJoint, PositionIsTheLimitNextToZero) {
  const auto position = [](const std::string& lower, const std::string& upper) {
    return jointOf("prismatic", "<limit lower=\"" + lower + "\" upper=\"" + upper + R"(" effort="1" velocity="1"/>)")
        .position;
  };
  EXPECT_EQ(position("-1", "1"), 0.0);
  EXPECT_EQ(position("0.25", "1"), 0.25);
  EXPECT_EQ(position("-1", "-0.5"), -0.5);
}

TEST(UrdfJoint, DynamicsAreRead) {
  const JointDescription none = jointOf("continuous", "");
  EXPECT_EQ(none.damping, 0.0);
  EXPECT_EQ(none.friction, 0.0);
  const JointDescription both = jointOf("continuous", R"(<dynamics damping="0.25" friction="0.5"/>)");
  EXPECT_EQ(both.damping, 0.25);
  EXPECT_EQ(both.friction, 0.5);
  EXPECT_EQ(jointOf("continuous", R"(<dynamics friction="0.5"/>)").damping, 0.0);
}

TEST(UrdfJoint, EachRefusalNamesElementValueAndExpectation) {
  struct Case {
    std::string xml;
    std::vector<std::string> mentions;
  };
  const auto limit = [](const std::string& values) { return "<limit " + values + " velocity=\"1\"/>"; };
  const std::string mimic = R"(<mimic joint="to_c"/>)";
  const std::string bare = "<link name=\"b\"/>", massive = link("b", kInertial), hollow = link("b", kBall);
  const std::string beyond = joint("a", "b", "continuous");
  const std::vector<Case> cases = {
      {pair("floating", ""),
       {"test.urdf: joint \"to_b\": type floating: expected fixed, revolute, continuous or prismatic"}},
      {pair("planar", ""), {"test.urdf: joint \"to_b\": type planar: expected fixed, revolute"}},
      {pair("ball", ""), {"test.urdf: malformed URDF", "to_b", "ball"}},
      {pair("revolute", ""), {"test.urdf: malformed URDF", "to_b", "does not specify limits"}},
      {pair("prismatic", ""), {"test.urdf: malformed URDF", "to_b", "without limits"}},
      {pair("revolute", limit(R"(lower="0" upper="1")")), {"test.urdf: malformed URDF", "effort"}},
      {pair("revolute", limit(R"(lower="1" upper="0.5" effort="1")")),
       {"joint \"to_b\" limit: lower 1, upper 0.5: expected finite numbers, lower at most upper"}},
      {pair("prismatic", limit(R"(lower="nan" upper="1" effort="1")")), {"test.urdf: ", "nan"}},
      {pair("prismatic", limit(R"(lower="0" upper="inf" effort="1")")), {"test.urdf: ", "inf"}},
      {pair("revolute", limit(R"(lower="0" upper="1" effort="-1")")),
       {"joint \"to_b\" limit: effort -1: expected a finite number >= 0"}},
      {pair("continuous", limit(R"(effort="-2")")), {"joint \"to_b\" limit: effort -2: expected"}},
      {pair("continuous", R"(<axis xyz="0 0 0"/>)"),
       {"joint \"to_b\": axis [0, 0, 0]: expected finite numbers, not all 0"}},
      {pair("continuous", R"(<axis xyz="0 0 inf"/>)"), {"test.urdf: ", "inf"}},
      {pair("continuous", R"(<dynamics damping="-0.5"/>)"),
       {"joint \"to_b\" dynamics: damping -0.5: expected a finite number >= 0"}},
      {pair("continuous", R"(<dynamics friction="-1"/>)"), {"joint \"to_b\" dynamics: friction -1: expected"}},
      {robot(link("a") + link("b") + link("c") + joint("a", "c", "continuous") + joint("a", "b", "continuous", mimic)),
       {"joint \"to_b\": mimic of joint \"to_c\": expected none"}},
      {robot(link("a") + link("b-1") + joint("a", "b-1", "continuous")),
       {"link \"b-1\" beyond joint \"to_b-1\": expected a name that is a letter followed by"}},
      {robot(link("a") + link("1b") + joint("a", "1b", "continuous")), {"link \"1b\" beyond joint"}},
      {robot(link("a") + link("b/c") + joint("a", "b/c", "continuous")), {"link \"b/c\" beyond joint"}},
      {robot(link("a") + bare + beyond), {"link \"b\": no <collision>: expected", "link \"b\" inertial: mass 0 kg"}},
      {robot(link("a") + massive + beyond), {"link \"b\": no <collision>: expected", "every body"}},
      {robot(link("a") + hollow + beyond), {"link \"b\" inertial: mass 0 kg: expected a finite mass > 0"}},
      {robot(link("a", "") + link("b") + beyond), {"link \"a\": no <collision>"}},
      {robot(link("a") + hollow + link("c", "") + beyond + joint("b", "c", "fixed")),
       {"links \"b\", \"c\" inertial (all together): mass 0 kg"}},
  };
  for (const Case& c : cases) {
    const Result result = read(c.xml);
    EXPECT_NE(result.errors, "") << c.xml;
    EXPECT_FALSE(result.bodies.empty());
    for (const std::string& mention : c.mentions) {
      EXPECT_NE(result.errors.find(mention), std::string::npos) << "no \"" << mention << "\" in: " << result.errors;
    }
  }
}

TEST(UrdfJoint, LinksOfABodyAreNamedAsFarAsThereIsRoom) {
  std::string content = link("a", "");
  for (int i = 0; i < 9; ++i) {
    const std::string name = "l" + std::to_string(i);
    content += link(name, "") + joint("a", name, "fixed");
  }
  const std::string errors = read(robot(content)).errors;
  EXPECT_NE(errors.find("links \"a\", \"l0\", \"l1\", \"l2\" and 6 more: no <collision>"), std::string::npos) << errors;
}

TEST(UrdfJoint, LinksThatAreNoTreeAreRefusedByName) {
  const std::string links = link("l") + link("m") + link("n");
  const auto errors = [&](const std::string& joints) { return read(robot(links + joints)).errors; };
  const auto turning = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"continuous\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/></joint>";
  };
  const std::string twice = errors(turning("i", "l", "m") + turning("j", "l", "n") + turning("k", "m", "n"));
  EXPECT_NE(twice.find("link \"n\" is the child of two joints"), std::string::npos) << twice;
  const std::string loose = errors(turning("i", "m", "n") + turning("j", "n", "m"));
  EXPECT_NE(loose.find("link \"m\" does not hang on the root, \"l\""), std::string::npos) << loose;
}

TEST(UrdfJoint, AChainTooLongToFollowIsRefused) {
  const auto chain = [](int joints) {
    std::string content = link("l0");
    for (int i = 1; i <= joints; ++i) {
      content += link("l" + std::to_string(i));
      content += joint("l" + std::to_string(i - 1), "l" + std::to_string(i), "continuous");
    }
    return robot(content);
  };
  const Result longest = read(chain(1000));
  EXPECT_EQ(longest.errors, "");
  EXPECT_EQ(longest.bodies.size(), 1001u);
  EXPECT_NE(read(chain(1001)).errors.find("link \"l1001\" is more than 1000 joints from the root"), std::string::npos);
}

}  // namespace
}  // namespace monolith
