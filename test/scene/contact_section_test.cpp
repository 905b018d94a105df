// The scene's contact section: coefficients, pairs, materials, and what is wrong with them.

#include <gtest/gtest.h>

#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

const char* kBall = R"(<robot name="ball"><link name="ball"><inertial><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>)";

class ContactSection : public testing::Test {
 protected:
  ContactSection() { folder_.write("ball.urdf", kBall); }

  Scene load(const std::string& contact) const {
    return loadScene(folder_.write("scene.yaml",
                                   "tank: {size: [1.0, 0.8, 0.6], cell_width: 0.1}\n"
                                   "bodies:\n"
                                   "  - {name: ball, urdf: ball.urdf, position: [0, 0, 0.3], material: rubber}\n"
                                   "  - {name: other, urdf: ball.urdf, position: [0.3, 0, 0.3]}\n" +
                                       contact),
                     SceneResolver());
  }
  std::string errorOf(const std::string& contact) const {
    try {
      load(contact);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

TEST_F(ContactSection, DefaultIsNeitherFrictionNorRestitution) {
  const Scene scene = load("");
  EXPECT_EQ(scene.contact.friction, 0.0);
  EXPECT_EQ(scene.contact.restitution, 0.0);
  EXPECT_TRUE(scene.contact.pairs.empty());
  EXPECT_EQ(scene.bodies[0].material, "rubber");
}

TEST_F(ContactSection, PairsInheritWhatTheyDoNotSay) {
  const Scene scene = load(
      "contact: {friction: 0.3, restitution: 0.2, pairs: [{between: [rubber, walls], friction: 0.9}, "
      "{between: [other, ball], restitution: 1}]}\n");
  ASSERT_EQ(scene.contact.pairs.size(), 2u);
  EXPECT_EQ(scene.contact.pairs[0].friction, 0.9);
  EXPECT_EQ(scene.contact.pairs[0].restitution, 0.2);
  EXPECT_EQ(scene.contact.pairs[1].friction, 0.3);
  EXPECT_EQ(scene.contact.pairs[1].restitution, 1.0);
  EXPECT_EQ(scene.contact.pairs[1].a, "other");
}

TEST_F(ContactSection, EachViolationIsNamed) {
  const auto expect = [&](const std::string& contact, const std::vector<std::string>& mentions) {
    const std::string error = errorOf(contact);
    for (const std::string& mention : mentions) {
      EXPECT_NE(error.find(mention), std::string::npos) << "no \"" << mention << "\" in: " << error;
    }
  };
  expect("contact: {friction: -0.1}\n", {"scene.yaml:5", "contact.friction", "-0.1"});
  expect("contact: {restitution: 1.5}\n", {"contact.restitution", "1.5", "at most 1"});
  expect("contact: {frictoin: 0.1}\n", {"frictoin", "friction"});
  expect("contact: {pairs: 3}\n", {"contact.pairs", "a list"});
  expect("contact: {pairs: [{friction: 0.1}]}\n", {"contact.pairs[0].between"});
  expect("contact: {pairs: [{between: [ball]}]}\n", {"contact.pairs[0].between", "two names"});
  expect("contact: {pairs: [{between: [rubbr, walls]}]}\n", {"contact.pairs[0].between", "rubbr", "rubber"});
  const std::string repeated = "a pair that no entry before has", itself = "not one thing and itself";
  expect("contact: {pairs: [{between: [ball, walls]}, {between: [walls, ball]}]}\n",
         {"scene.yaml:5: contact.pairs[1].between: value [walls, ball]", repeated});
  expect("contact: {pairs: [{between: [ball, other]}, {between: [ball, other]}]}\n",
         {"contact.pairs[1].between", repeated});
  expect("contact: {pairs: [{between: [walls, walls]}]}\n", {"contact.pairs[0].between", itself});
  expect("contact: {pairs: [{between: [ball, ball]}]}\n", {"contact.pairs[0].between", itself});
  // Two bodies may have one material.
  EXPECT_EQ(errorOf("contact: {pairs: [{between: [rubber, rubber]}, {between: [rubber, walls]}]}\n"), "no error");
}

TEST_F(ContactSection, SolverNamesAreChecked) {
  EXPECT_EQ(load("solver: {name: direct, coupling: iterative}\n").solver.name, SolverName::kDirect);
  EXPECT_EQ(load("solver: {coupling: iterative}\n").solver.coupling, CouplingName::kIterative);
  EXPECT_EQ(load("").solver.name, SolverName::kFast);
  EXPECT_NE(errorOf("solver: {name: quick}\n").find("fast, direct, reference"), std::string::npos)
      << errorOf("solver: {name: quick}\n");
}

}  // namespace
}  // namespace monolith
