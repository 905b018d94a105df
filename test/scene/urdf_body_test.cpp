// URDF texts -> one body, and what is refused; several bodies are in urdf_joint_test.cpp.

#include "scene/urdf_body.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "temporary_folder.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

const char* kInertial = R"(<inertial><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
const char* kBall = R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>)";

std::string robot(const std::string& content) { return "<robot name=\"r\">" + content + "</robot>"; }
std::string link(const std::string& name, const std::string& content) {
  return "<link name=\"" + name + "\">" + content + "</link>";
}
std::string joint(const std::string& type, const std::string& origin = "") {
  return "<joint name=\"j\" type=\"" + type + "\"><parent link=\"a\"/><child link=\"b\"/>" + origin +
         "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
}
std::string fixedJoint(const std::string& parent, const std::string& child) {
  return "<joint name=\"" + parent + "_" + child + "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" +
         child + "\"/></joint>";
}
std::string inertial(double mass, const std::string& moments, const std::string& origin = "") {
  return "<inertial>" + origin + "<mass value=\"" + std::to_string(mass) + "\"/><inertia " + moments + "/></inertial>";
}

struct Result {
  BodyDescription body;  // of the root link
  std::string errors;
};

Result read(const std::string& xml, const std::string& folder = "") {
  Result result;
  std::vector<BodyDescription> bodies;
  for (const std::string& line : readUrdfBodies({"test.urdf", folder, xml}, SceneResolver(), bodies)) {
    result.errors += line + "\n";
  }
  result.body = bodies.at(0);
  return result;
}

void expectRefused(const std::string& xml, const std::vector<std::string>& mentions) {
  const Result result = read(xml);
  EXPECT_NE(result.errors, "");
  for (const std::string& mention : mentions) {
    EXPECT_NE(result.errors.find(mention), std::string::npos) << "no \"" << mention << "\" in: " << result.errors;
  }
}

TEST(UrdfBody, FixedJointsMakeOneBody) {
  // Two halves of a dumb-bell, the second link turned by 90 degrees about z and its inertial frame moved.
  const std::string xml =
      robot(link("a", inertial(1.0, R"(ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2")") + kBall) +
            link("b", inertial(3.0, R"(ixx="0.4" ixy="0" ixz="0" iyy="0.6" iyz="0" izz="0.8")",
                               R"(<origin xyz="1 0 0" rpy="0 0 0"/>)") +
                          R"(<collision><origin xyz="0.5 0 0" rpy="0 0 0"/>
                      <geometry><box size="1 2 3"/></geometry></collision>)") +
            joint("fixed", R"(<origin xyz="2 0 0" rpy="0 0 1.5707963267948966"/>)"));
  const Result result = read(xml);
  ASSERT_EQ(result.errors, "");
  const BodyDescription& body = result.body;
  ASSERT_EQ(body.links.size(), 2u);
  EXPECT_EQ(body.links[0].name, "a");
  EXPECT_EQ(body.links[1].name, "b");
  EXPECT_LT((body.links[1].X_BL.translation() - Vector3d(2, 0, 0)).norm(), 1e-12);
  ASSERT_EQ(body.shapes.size(), 2u);
  EXPECT_EQ(body.shapes[1].name, "b/collision[0]");
  EXPECT_LT((body.shapes[1].X_BG.translation() - Vector3d(2, 0.5, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(body.mass, 4.0);
  EXPECT_LT((body.p_BBcm - Vector3d(1.5, 0.75, 0)).norm(), 1e-12);
  // By hand: centres at (0,0,0) and (2,1,0), reduced mass 3/4 times their distance vector, b's x and y swapped.
  Eigen::Matrix3d expected = Vector3d(0.1 + 0.6, 0.2 + 0.4, 0.2 + 0.8).asDiagonal();
  const Vector3d d(2, 1, 0);
  expected += 0.75 * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  EXPECT_LT((body.inertia_Bcm - expected).norm(), 1e-12);
}

TEST(UrdfBody, ReadsEveryPrimitiveAndLinksWithoutInertial) {
  const Result result =
      read(robot(link("a", std::string(kInertial) + kBall +
                               R"(<collision><geometry><cylinder radius="0.2" length="0.7"/></geometry></collision>
                       <collision><geometry><box size="1 2 3"/></geometry></collision>)") +
                 link("b", "") + joint("fixed")));
  ASSERT_EQ(result.errors, "");
  ASSERT_EQ(result.body.shapes.size(), 3u);
  EXPECT_EQ(result.body.shapes[0].kind, Shape::Kind::kSphere);
  EXPECT_DOUBLE_EQ(result.body.shapes[0].radius, 0.1);
  EXPECT_EQ(result.body.shapes[1].kind, Shape::Kind::kCylinder);
  EXPECT_DOUBLE_EQ(result.body.shapes[1].length, 0.7);
  EXPECT_EQ(result.body.shapes[2].box_size, Vector3d(1, 2, 3));
  EXPECT_DOUBLE_EQ(result.body.mass, 2.0);
}

TEST(UrdfBody, WrongMassesAndInertiasAreRefused) {
  const std::string unit = R"(ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1")";
  const std::string none = R"(ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0")";
  expectRefused(robot(link("a", inertial(0.0, unit) + kBall)), {"link \"a\"", "mass 0 kg with an inertia"});
  expectRefused(robot(link("a", inertial(0.0, none) + kBall)), {"mass 0 kg", "expected a finite mass > 0"});
  expectRefused(robot(link("a", inertial(1.0, none) + kBall)), {"positive definite"});
  expectRefused(robot(link("a", inertial(-1.0, unit) + kBall)), {"link \"a\"", "-1"});
  expectRefused(robot(link("a", kBall)), {"mass 0 kg"});
  expectRefused(robot(link("a", inertial(1.0, R"(ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="3")") + kBall)),
                {"triangle inequality", "1, 1, 3"});
  expectRefused(robot(link("a", inertial(1.0, R"(ixx="1" ixy="2" ixz="0" iyy="1" iyz="0" izz="1")") + kBall)),
                {"link \"a\"", "-1, 1, 3", "none below zero"});
  expectRefused(robot(link("a", inertial(1.0, R"(ixx="nan" ixy="0" ixz="0" iyy="1" iyz="0" izz="1")") + kBall)),
                {"test.urdf"});
}

TEST(UrdfBody, EachLinksInertiaIsCheckedAndNotOnlyTheirSum) {
  const auto withChild = [](double mass, const std::string& moments) {
    return robot(link("a", std::string(kInertial) + kBall) + link("b", inertial(mass, moments)) + joint("fixed"));
  };
  // The root's moments outweigh each of these.
  expectRefused(withChild(1.0, R"(ixx="-0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1")"),
                {"test.urdf: link \"b\" inertial", "-0.1, 0.1, 0.1", "none below zero"});
  expectRefused(withChild(1.0, R"(ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.3")"),
                {"test.urdf: link \"b\" inertial", "0.1, 0.1, 0.3", "triangle inequality"});
  expectRefused(withChild(0.0, R"(ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1")"),
                {"test.urdf: link \"b\" inertial", "mass 0 kg with an inertia"});
  // A point mass, a rod and a link that is a frame only.
  for (const auto& [mass, moment] : {std::pair(1.0, "0"), std::pair(1.0, "0.1"), std::pair(0.0, "0")}) {
    const Result result = read(withChild(
        mass, std::string(R"(ixx="0" ixy="0" ixz="0" iyy=")") + moment + R"(" iyz="0" izz=")" + moment + "\""));
    EXPECT_EQ(result.errors, "");
    EXPECT_DOUBLE_EQ(result.body.mass, 2.0 + mass);
  }
}

TEST(UrdfBody, LinksThatAreNoTreeAreRefusedByName) {
  const auto joined = [](const std::string& joints) {
    std::string links;
    for (const char* name : {"l", "m", "n"}) links += link(name, std::string(kInertial) + kBall);
    return robot(links + joints);
  };
  const std::string twice = "is the child of two joints", loose = "does not hang on the root, \"l\"";
  struct Case {
    std::string joints;
    std::vector<std::string> mentions;
  };
  const std::vector<Case> cases = {
      {fixedJoint("l", "m") + fixedJoint("l", "n") + fixedJoint("m", "n"), {"link \"n\" " + twice}},
      {fixedJoint("l", "m") + fixedJoint("m", "m") + fixedJoint("l", "n"), {"link \"m\" " + twice}},
      {fixedJoint("l", "m") + fixedJoint("m", "n") + fixedJoint("n", "m"), {"link \"m\" " + twice}},
      {fixedJoint("m", "n") + fixedJoint("n", "m"), {"link \"m\" " + loose, "link \"n\" " + loose}},
  };
  for (const Case& c : cases) {
    expectRefused(joined(c.joints), c.mentions);
    // Nothing is counted twice.
    const Result result = read(joined(c.joints));
    EXPECT_LE(result.body.links.size(), 3u) << c.joints;
    EXPECT_EQ(result.body.shapes.size(), result.body.links.size()) << c.joints;
  }
}

TEST(UrdfBody, AChainTooLongToFollowIsRefused) {
  const auto chain = [](int joints) {
    std::string content = link("l0", std::string(kInertial) + kBall);
    for (int i = 1; i <= joints; ++i) {
      content += link("l" + std::to_string(i), "");
      content += fixedJoint("l" + std::to_string(i - 1), "l" + std::to_string(i));
    }
    return robot(content);
  };
  EXPECT_EQ(read(chain(1000)).errors, "");
  expectRefused(chain(1001), {"link \"l1001\" is more than 1000 joints from the root"});
}

TEST(UrdfBody, WrongGeometryIsRefused) {
  const auto with = [](const std::string& geometry) {
    return robot(link("a", kInertial + ("<collision><geometry>" + geometry + "</geometry></collision>")));
  };
  expectRefused(robot(link("a", kInertial)), {"no <collision>"});
  expectRefused(with(R"(<sphere radius="0"/>)"), {"a/collision[0]", "sphere radius 0", "> 0"});
  expectRefused(with(R"(<box size="1 -1 1"/>)"), {"box size", "-1"});
  expectRefused(with(R"(<cylinder radius="1" length="0"/>)"), {"cylinder length"});
  expectRefused(with(R"(<mesh filename="m.stl"/>)"), {"m.stl", "relative path"});
  expectRefused(with(R"(<mesh filename="file:///nowhere/m.stl"/>)"), {"/nowhere/m.stl", "no such file"});
  expectRefused(with(R"(<mesh filename="package://nobody/m.stl"/>)"), {"package \"nobody\" not found"});
  expectRefused(with(R"(<mesh filename="http://nowhere/m.stl"/>)"), {"http://nowhere/m.stl", "expected package://"});
  expectRefused(with(R"(<mesh filename="file:///m.stl" scale="1 0 1"/>)"), {"scale"});
}

TEST(UrdfBody, ParserMessagesBecomePartOfTheError) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  expectRefused("this is no XML", {"test.urdf", "malformed URDF"});
  expectRefused("", {"test.urdf", "malformed URDF"});
  expectRefused(robot(link("a", kBall) + link("a", kBall)), {"'a' is not unique"});
  expectRefused(robot(link("a", kBall) + link("b", kBall)), {"Two root links"});
  expectRefused(robot(link("a", R"(<collision><geometry><sphere radius="big"/></geometry></collision>)")), {"big"});
  expectRefused(R"(<robot name="r"><xacro:property name="x" value="1"/></robot>)", {"xacro"});
  std::string deep = "<robot name='r' note='a > b <!--'><!-- <link> -->";
  for (int i = 0; i < 50000; ++i) deep += "<link>";
  expectRefused(deep, {"elements 50001 deep in each other: expected at most 100"});
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
}

TEST(UrdfBody, SeveralViolationsAreReportedTogether) {
  const Result result =
      read(robot(link("a", std::string(kInertial) + R"(<collision><geometry><sphere radius="-1"/></geometry></collision>
      <collision><geometry><box size="0 1 1"/></geometry></collision>)") +
                 link("b", "") + joint("floating")));
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 3);
}

TEST(UrdfBody, RelativeMeshPathsBecomeAbsoluteInTheText) {
  const TemporaryFolder folder;
  folder.write("meshes/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string geometry = R"(<geometry><mesh filename="meshes/t.obj" scale="0.1 0.1 0.1"/></geometry>)";
  const Result result =
      read(robot(link("a", kInertial + ("<visual>" + geometry + "</visual><collision>" + geometry + "</collision>"))),
           folder.path());
  ASSERT_EQ(result.errors, "");
  ASSERT_TRUE(result.body.shapes[0].mesh);
  EXPECT_NEAR(volume(result.body.shapes[0]), 1e-3 / 6.0, 1e-9);
  const std::string absolute = "filename=\"file://" + folder.path() + "/meshes/t.obj\"";
  const std::size_t first = result.body.urdf_xml.find(absolute);
  ASSERT_NE(first, std::string::npos) << result.body.urdf_xml;
  EXPECT_NE(result.body.urdf_xml.find(absolute, first + 1), std::string::npos);
  EXPECT_EQ(read(result.body.urdf_xml).errors, "");
}

TEST(UrdfBody, MeshPathsMayHaveCharactersThatXmlEscapes) {
  const TemporaryFolder folder;
  const std::string name = "salt & 'pepper' <fine> \"1\"";
  folder.write(name + "/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string escaped = "salt &amp; &apos;pepper&#39; &lt;fine> &quot;1&#x22;";
  // A link may be called as the file is.
  for (const std::string& file : {std::string("t.obj"), "../" + escaped + "/t.obj"}) {
    const std::string collision =
        "<collision><geometry><mesh filename = '" + file + "' scale=\"0.1 0.1 0.1\"/></geometry></collision>";
    const Result result = read(robot(link("t.obj", kInertial + collision)), folder.path() + "/" + name);
    ASSERT_EQ(result.errors, "") << file;
    const Result again = read(result.body.urdf_xml);
    EXPECT_EQ(again.errors, "") << result.body.urdf_xml;
    EXPECT_EQ(again.body.shapes.size(), 1u);
    EXPECT_EQ(again.body.links[0].name, "t.obj");
  }
}

}  // namespace
}  // namespace monolith
