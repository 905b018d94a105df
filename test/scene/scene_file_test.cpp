// YAML -> Scene: what is read, and that each violation is named with its line, key, value and expectation.

#include "scene/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/nearest_word.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

const char* kBall = R"(<robot name="ball"><link name="ball"><inertial><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>)";
const std::string kTank = "tank: {size: [1.0, 0.8, 0.6], cell_width: 0.1}\n";
const std::string kBody = "bodies:\n  - name: ball\n    urdf: ball.urdf\n    position: [0.0, 0.0, 0.3]\n";

class SceneFile : public testing::Test {
 protected:
  SceneFile() { folder_.write("ball.urdf", kBall); }

  Scene load(const std::string& yaml, const SceneResolver& resolver = SceneResolver()) const {
    return loadScene(folder_.write("scene.yaml", yaml), resolver);
  }

  // Every line of the error starts with the file; returned without its folder.
  std::string errorOf(const std::string& yaml, const SceneResolver& resolver = SceneResolver()) const {
    try {
      load(yaml, resolver);
    } catch (const SceneError& error) {
      std::string text = error.what();
      EXPECT_EQ(text.find(folder_.path() + "/scene.yaml:"), 0u) << text;
      for (std::size_t at; (at = text.find(folder_.path() + "/")) != std::string::npos;) {
        text.erase(at, folder_.path().size() + 1);
      }
      return text;
    }
    return "no error";
  }

  void expectError(const std::string& yaml, const std::vector<std::string>& mentions) const {
    const std::string error = errorOf(yaml);
    for (const std::string& mention : mentions) {
      EXPECT_NE(error.find(mention), std::string::npos) << "no \"" << mention << "\" in: " << error;
    }
  }

  TemporaryFolder folder_;
};

TEST_F(SceneFile, DefaultsAreThoseOfTheDescriptions) {
  const Scene scene = load(kTank);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.gravity, Scene().gravity);
  EXPECT_EQ(scene.time_step, Scene().time_step);
  EXPECT_EQ(scene.liquid.density, LiquidDescription().density);
  EXPECT_EQ(scene.liquid.fill_level, 0.0);
  EXPECT_EQ(scene.solver.tolerance, SolverDescription().tolerance);
  EXPECT_EQ(scene.solver.discretisation, Discretisation::kFitted);
  EXPECT_EQ(scene.solver.time_stepping, TimeStepping::kBdf2);
  EXPECT_TRUE(scene.bodies.empty());
  EXPECT_LT((scene.tank.origin - Vector3d(-0.5, -0.4, 0.0)).norm(), 1e-15);  // centred, floor at 0
}

TEST_F(SceneFile, EveryValueArrives) {
  const Scene scene = load(R"(
name: all
tank: {size: [2.0, 1.0, 1.0], cell_width: 0.1, origin: [1.0, 2.0, 3.0], periodic: [true, false, true]}
liquid:
  density: 900
  dynamic_viscosity: 0.5
  fill_level: 1.0
  boxes: [{min: [1.0, 2.0, 3.0], max: [2.0, 3.0, 3.5]}]
gravity: [1.0, 0.0, -2.0]
time_step: 0.05
solver: {discretisation: fractions, time_stepping: backward_euler, tolerance: 1e-8, maximum_iterations: 7, threads: 2,
         cfl: 0.5}
bodies:
  - name: free_one
    urdf: ball.urdf
    position: [1.5, 2.5, 3.5]
    orientation: {rpy: [0.3, -0.4, 0.5]}
    velocity: [1, 2, 3]
    angular_velocity: [4, 5, 6]
  - {name: still, urdf: ball.urdf, position: [2.5, 2.5, 3.5], motion: fixed}
  - name: moved
    urdf: ball.urdf
    position: [2.0, 2.5, 3.5]
    orientation: {quaternion: [0, 0, 0.70710678, 0.70710678]}
    motion: prescribed
    prescribed: {twist: [1, 2, 3, 4, 5, 6], amplitude: [6, 5, 4, 3, 2, 1], frequency: 2, phase: 0.25, in_place: true}
)");
  EXPECT_EQ(scene.name, "all");
  EXPECT_EQ(scene.tank.size, Vector3d(2, 1, 1));
  EXPECT_EQ(scene.tank.origin, Vector3d(1, 2, 3));
  EXPECT_TRUE(scene.tank.periodic[0] && !scene.tank.periodic[1] && scene.tank.periodic[2]);
  EXPECT_EQ(scene.liquid.density, 900.0);
  EXPECT_EQ(scene.liquid.dynamic_viscosity, 0.5);
  EXPECT_EQ(scene.liquid.fill_level, 1.0);
  ASSERT_EQ(scene.liquid.boxes.size(), 1u);
  EXPECT_EQ(scene.liquid.boxes[0].max(), Vector3d(2, 3, 3.5));
  EXPECT_EQ(scene.gravity, Vector3d(1, 0, -2));
  EXPECT_EQ(scene.time_step, 0.05);
  EXPECT_EQ(scene.solver.discretisation, Discretisation::kFractions);
  EXPECT_EQ(scene.solver.time_stepping, TimeStepping::kBackwardEuler);
  EXPECT_EQ(scene.solver.tolerance, 1e-8);
  EXPECT_EQ(scene.solver.maximum_iterations, 7);
  EXPECT_EQ(scene.solver.threads, 2);
  EXPECT_EQ(scene.solver.cfl, 0.5);
  ASSERT_EQ(scene.bodies.size(), 3u);
  const BodyDescription& free = scene.bodies[0];
  EXPECT_EQ(free.mass, 2.0);
  EXPECT_EQ(free.velocity, Vector3d(1, 2, 3));
  EXPECT_EQ(free.angular_velocity, Vector3d(4, 5, 6));
  EXPECT_EQ(free.X_WB.translation(), Vector3d(1.5, 2.5, 3.5));
  // Fixed axes: the roll first, the yaw last.
  EXPECT_LT((free.X_WB.linear() * Vector3d::UnitX() -
             Vector3d(std::cos(0.5) * std::cos(-0.4), std::sin(0.5) * std::cos(-0.4), -std::sin(-0.4)))
                .norm(),
            1e-14);
  EXPECT_NEAR((free.X_WB.linear() * Vector3d::UnitZ()).z(), std::cos(0.3) * std::cos(-0.4), 1e-14);
  EXPECT_EQ(scene.bodies[1].motion, BodyMotion::kFixed);
  const BodyDescription& moved = scene.bodies[2];
  EXPECT_EQ(moved.motion, BodyMotion::kPrescribed);
  EXPECT_LT((moved.X_WB.linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-8);
  EXPECT_LT((moved.X_WB.linear().transpose() * moved.X_WB.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_EQ(moved.prescribed.twist[5], 6.0);
  EXPECT_EQ(moved.prescribed.amplitude[0], 6.0);
  EXPECT_EQ(moved.prescribed.frequency, 2.0);
  EXPECT_EQ(moved.prescribed.phase, 0.25);
  EXPECT_TRUE(moved.prescribed.in_place);
}

TEST_F(SceneFile, EachViolationNamesLineKeyValueAndExpectation) {
  struct Case {
    std::string yaml;
    std::vector<std::string> mentions;
  };
  const auto tank = [](const std::string& keys) { return "tank:\n" + keys; };
  const auto liquid = [](const std::string& keys) { return kTank + "liquid: {" + keys + "}\n"; };
  const auto body = [](const std::string& keys) { return kTank + kBody + "    " + keys + "\n"; };
  const std::vector<Case> cases = {
      {"name: x\n", {"scene.yaml:1: tank: missing"}},
      {"tank: 3\n", {"scene.yaml:1: tank: value 3: expected a map"}},
      {"[1, 2]\n", {"expected a map"}},
      {"", {"expected a map"}},
      {tank("  cell_width: 0.1\n"), {"tank.size: missing"}},
      {tank("  size: [1, 1, 1]\n"), {"tank.cell_width: missing"}},
      {tank("  size: [1, 1, 1]\n  cell_width: 0\n"), {"scene.yaml:3: tank.cell_width: value 0: expected", "> 0"}},
      {tank("  size: [1, 1, 1]\n  cell_width: -0.1\n"), {"value -0.1"}},
      {tank("  size: [1, 1, 1]\n  cell_width: .nan\n"), {"value .nan"}},
      {tank("  size: [1, 1, 1]\n  cell_width: 5 cm\n"), {"value 5 cm"}},
      {tank("  size: [1, 1, 1]\n  cell_width: [0.1]\n"), {"value [0.1]"}},
      {tank("  size: [1e201, 1e201, 1e201]\n  cell_width: 1e200\n"),
       {"scene.yaml:3: tank.cell_width: value 1e200: expected from 1e-9 to 1e9 m"}},
      {tank("  size: [1e-9, 1e-9, 1e-9]\n  cell_width: 1e-10\n"), {"tank.cell_width: value 1e-10", "from 1e-9"}},
      {tank("  size: [1, 0, 1]\n  cell_width: 0.1\n"),
       {"scene.yaml:2: tank.size: value [1, 0, 1]: expected a list of 3"}},
      {tank("  size: [1, 1]\n  cell_width: 0.1\n"), {"value [1, 1]"}},
      {tank("  size: [1, 1.05, 1]\n  cell_width: 0.1\n"), {"along y", "1 or 1.1 m"}},
      {tank("  size: [1, 1, 0.3]\n  cell_width: 0.1\n"), {"at least 4 cells", "along z", "not 3"}},
      {tank("  size: [100, 100, 100]\n  cell_width: 0.001\n") + "liquid: {fill_level: 1}\n",
       {"scene.yaml:3: tank.cell_width: value 0.001: expected", "1e+15 cells need about 1.7e+09 GB by this solver"}},
      {tank("  size: [1, 1, 1]\n  cell_width: 0.1\n  periodic: true\n"), {"tank.periodic: value true"}},
      {tank("  size: [1, 1, 1]\n  cell_width: 0.1\n  origin: [0, -1.1e8, 0]\n"),
       {"scene.yaml:4: tank.origin: value [0, -1.1e8, 0]: expected", "at most 1e+08 m, 1e9 cells"}},
      {tank("  size: [1, 1, 1]\n  cell_with: 0.1\n"), {"scene.yaml:3: tank.cell_with: unknown key", "\"cell_width\""}},
      {kTank + "liqid: {}\n", {"scene.yaml:2: liqid: unknown key", "\"liquid\""}},
      {kTank + kTank, {"scene.yaml:2: tank: given twice"}},
      {liquid("density: 0"), {"scene.yaml:2: liquid.density: value 0"}},
      {liquid("dynamic_viscosity: -1"), {"liquid.dynamic_viscosity: value -1", ">= 0"}},
      {liquid("fill_level: 0.61"), {"liquid.fill_level: value 0.61", "0.6"}},
      {liquid("fill_level: -0.1"), {"liquid.fill_level: value -0.1"}},
      {liquid("fill_level: 0.05"), {"liquid.fill_level: value 0.05", "0, or more than half a cell, 0.05"}},
      {liquid("boxes: 3"), {"liquid.boxes: value 3: expected a list"}},
      {liquid("boxes: [{min: [0, 0, 0]}]"), {"liquid.boxes[0].max: missing"}},
      {liquid("boxes: [{min: [0, 0, 0.2], max: [0.1, 0.1, 0.1]}]"), {"liquid.boxes[0].max", "more than min"}},
      {liquid("boxes: [{min: [0, 0, 0], max: [0.6, 0.1, 0.1]}]"), {"liquid.boxes[0]", "inside the tank"}},
      {liquid("boxes: [{min: [0, 0, 0], max: [0.1, 0.1, 0.1]}, {min: [0, 0.06, 0], max: [0.1, 0.14, 0.1]}]"),
       {"scene.yaml:2: liquid.boxes[1]: value {min: [0, 0.06, 0]", "holds the centre of a cell", "0.1 m"}},
      {liquid("boxes: [{min: [0, 0, 0], max: [0.1, 0.1, 0.05]}]"), {"liquid.boxes[0]", "holds the centre of a cell"}},
      {kTank + "time_step: 0\n", {"scene.yaml:2: time_step: value 0"}},
      {kTank + "gravity: [0, 0, -1e20]\n", {"scene.yaml:2: gravity: value [0, 0, -1e20]: expected at most 1e6 m/s^2"}},
      {kTank + "time_step: 2e9\n", {"scene.yaml:2: time_step: value 2e9: expected at most 1e6 s"}},
      {kTank + "---\n" + kTank, {"scene.yaml:3: a further YAML document"}},
      {kTank + "gravity: -9.81\n", {"gravity: value -9.81: expected a list of 3"}},
      {kTank + "name: []\n", {"name: value []"}},
      {kTank + "solver: {discretisation: fitter}\n", {"solver.discretisation: value fitter", "fitted", "fractions"}},
      {kTank + "solver: {time_stepping: bdf3}\n", {"solver.time_stepping: value bdf3", "backward_euler", "bdf2"}},
      {kTank + "solver: {tolerance: 2}\n", {"solver.tolerance: value 2"}},
      {kTank + "solver: {tolerance: 0}\n", {"solver.tolerance: value 0"}},
      {kTank + "liquid: {density: 1e-10}\n", {"liquid.density: value 1e-10", "from 1e-9 to 1e9"}},
      {kTank + "liquid: {dynamic_viscosity: 1e300}\n", {"liquid.dynamic_viscosity: value 1e300", "at most 1e15"}},
      {kTank + "solver: {tolerance: 1e-13}\n", {"solver.tolerance: value 1e-13", "at least 1e-12"}},
      {kTank + "solver: {maximum_iterations: 0}\n", {"solver.maximum_iterations: value 0", "from 1 to"}},
      {kTank + "solver: {maximum_iterations: 2147483648}\n",
       {"solver.maximum_iterations: value 2147483648: expected a whole number from 1 to 2147483647"}},
      {kTank + "solver: {maximum_iterations: 3.5}\n", {"solver.maximum_iterations: value 3.5", "whole number"}},
      {kTank + "solver: {threads: 1.5}\n", {"solver.threads: value 1.5", "whole number"}},
      {kTank + "solver: {threads: 1000000}\n", {"solver.threads: value 1000000", "a whole number from 0 to 1024"}},
      {kTank + "solver: {threads: -1}\n", {"solver.threads: value -1", "a whole number from 0 to 1024"}},
      {kTank + "bodies: {}\n", {"bodies: value {}: expected a list"}},
      {kTank + "bodies: [ball]\n", {"bodies[0]: value ball: expected a map"}},
      {kTank + "bodies: [{urdf: ball.urdf, position: [0, 0, 0.3]}]\n", {"bodies[0].name: missing"}},
      {kTank + "bodies: [{name: a}]\n", {"bodies[0].urdf, urdf_parameter: neither"}},
      {kTank + "bodies: [{name: a, urdf: ball.urdf, urdf_parameter: x}]\n", {"both are given"}},
      {kTank + "bodies: [{name: a, urdf: none.urdf}]\n", {"bodies[0].urdf: value \"none.urdf\": no such file"}},
      {kTank + "bodies: [{name: a, urdf: scene.yaml}]\n", {"bodies[0].urdf: scene.yaml: malformed URDF"}},
      {kTank + "bodies: [{name: a, urdf: 'package://p/x.urdf'}]\n", {"package \"p\" not found"}},
      {kTank + "bodies: [{name: a, urdf_parameter: /x}]\n", {"bodies[0].urdf_parameter: value /x", "ROS parameter"}},
      {kTank + "bodies: [{name: 2a, urdf: ball.urdf}]\n", {"bodies[0].name: value 2a: expected a letter"}},
      {kTank + "bodies: [{name: a-b, urdf: ball.urdf}]\n", {"bodies[0].name: value a-b"}},
      {kTank + "bodies: [{name: world, urdf: ball.urdf}]\n", {"bodies[0].name: value world"}},
      {kTank + kBody + kBody.substr(kBody.find('\n') + 1), {"scene.yaml:6: bodies[1].name: value ball", "bodies[0]"}},
      {body("orientation: {}"), {"scene.yaml:6: bodies[0].orientation", "exactly one"}},
      {body("orientation: {quaternion: [0, 0, 0, 1.1]}"), {"bodies[0].orientation.quaternion", "norm 1.1"}},
      {body("orientation: {rpy: [0, 0]}"), {"bodies[0].orientation.rpy: value [0, 0]"}},
      {body("material: walls"), {"bodies[0].material: value walls: expected another name"}},
      {body("motion: fixd"), {"bodies[0].motion: value fixd", "\"fixed\""}},
      {body("motion: prescribed"), {"bodies[0].prescribed: missing"}},
      {body("prescribed: {twist: [1, 0, 0, 0, 0, 0]}"), {"bodies[0].prescribed", "motion: prescribed"}},
      {body("motion: fixed\n    velocity: [1, 0, 0]"), {"bodies[0].velocity", "motion: fixed"}},
      {body("motion: prescribed\n    prescribed: {amplitude: [1, 0, 0, 0, 0, 0]}"), {"frequency > 0"}},
      {body("motion: prescribed\n    prescribed: {twist: [1, 0, 0]}"), {"prescribed.twist", "list of 6"}},
  };
  for (const Case& c : cases) expectError(c.yaml, c.mentions);
}

TEST_F(SceneFile, WhatIsJustWithinTheLimitsIsAccepted) {
  EXPECT_EQ(errorOf(kTank + "liquid: {fill_level: 0.051}\n"), "no error");
  EXPECT_EQ(errorOf(kTank + "liquid: {boxes: [{min: [0.04, 0.04, 0.04], max: [0.06, 0.06, 0.06]}]}\n"), "no error");
  EXPECT_EQ(errorOf(kTank + "liquid: {boxes: [{min: [-0.5, -0.4, 0.0], max: [0.5, 0.4, 0.6]}]}\n"), "no error");
  EXPECT_EQ(errorOf("tank: {size: [1, 1, 1], cell_width: 0.1, origin: [1e8, 0, -1e8]}\n"), "no error");
  EXPECT_EQ(load(kTank + "solver: {maximum_iterations: 2147483647}\n").solver.maximum_iterations, 2147483647);
  // Decimal, not octal.
  EXPECT_EQ(load(kTank + "solver: {maximum_iterations: 010}\n").solver.maximum_iterations, 10);
}

TEST_F(SceneFile, AllViolationsAreReportedAtOnce) {
  const std::string error = errorOf(
      "tank: {size: [1, 1, 1], cell_width: 0.1, widht: 3}\nliquid: {density: -1, dynamic_viscosity: x}\n"
      "time_step: -1\nbodies:\n  - {name: 1, urdf: none.urdf}\n");
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 5) << error;
  for (const char* line : {":1: tank.widht", ":2: liquid.density", ":2: liquid.dynamic_viscosity", ":3: time_step",
                           ":5: bodies[0].name", ":5: bodies[0].urdf"}) {
    EXPECT_NE(error.find(line), std::string::npos) << line << " in " << error;
  }
}

TEST_F(SceneFile, ValuesThatContainThemselvesOrAreEndlessAreShownInPart) {
  expectError(kTank + "name: &a [*a]\n", {"scene.yaml:2: name: value [[[", "...", "expected a text"});
  expectError("tank: &t {size: *t, cell_width: 0.1}\n", {"tank.size: value {size: {size: ", "expected a list of 3"});
  expectError(kTank + "bodies: &b\n  - *b\n", {"bodies[0]: value [", "expected a map"});
  expectError(kTank + "? &k [*k]\n: 1\n", {"unknown key"});
  // Ten of ten of ten...: 10^9 entries.
  std::string yaml = "&l0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]";
  for (int level = 1; level < 9; ++level) {
    const std::string alias = "*l" + std::to_string(level - 1);
    yaml = "&l" + std::to_string(level) + " [" + yaml;
    for (int i = 1; i < 10; ++i) yaml += ", " + alias;
    yaml += "]";
  }
  EXPECT_LT(errorOf(kTank + "gravity: " + yaml + "\n").size(), 1000u);
  const std::string error = errorOf(kTank + "gravity: " + std::string(1000, 'x') + "\n");
  EXPECT_NE(error.find("xxx...: expected"), std::string::npos) << error;
  EXPECT_LT(error.size(), 500u);
  // Cut between characters: these have two bytes.
  std::string umlauts = "x";
  for (int i = 0; i < 500; ++i) umlauts += "\xc3\xa4";
  EXPECT_NE(errorOf(kTank + "gravity: " + umlauts + "\n").find("\xc3\xa4...: expected"), std::string::npos);
}

TEST_F(SceneFile, BodyThroughAWallIsNamedWithAxisAndExcess) {
  const auto at = [](const std::string& position) {
    return kTank + "bodies: [{name: ball, urdf: ball.urdf, position: " + position + "}]\n";
  };
  EXPECT_EQ(errorOf(at("[0.4, 0.0, 0.1]")), "no error");  // touches wall and floor
  expectError(at("[0.45, 0.0, 0.3]"), {"body \"ball\"", "0.05 m beyond the upper wall along x", "-0.5 to 0.5"});
  expectError(at("[0.0, -0.42, 0.3]"), {"0.12 m beyond the lower wall along y"});
  expectError(at("[0.0, 0.0, 7.0]"), {"6.5 m beyond the upper wall along z"});
  const std::string periodic = "tank: {size: [1.0, 0.8, 0.6], cell_width: 0.1, periodic: [true, true, true]}\n";
  EXPECT_NO_THROW(load(periodic + "bodies: [{name: ball, urdf: ball.urdf, position: [5, 0, 0]}]\n"));
}

TEST_F(SceneFile, ResolverFindsPackagesAndParameters) {
  SceneResolver resolver;
  resolver.package_path = [&](const std::string& package) { return package == "shop" ? folder_.path() : ""; };
  resolver.parameter = [](const std::string& name, std::string& text) {
    text = kBall;
    return name == "/robot_description";
  };
  const Scene scene = load(kTank + R"(bodies:
  - {name: a, urdf: "package://shop/ball.urdf", position: [0, 0, 0.3]}
  - {name: b, urdf_parameter: /robot_description, position: [0, 0, 0.3]}
  - {name: c, urdf: "file://)" +
                               folder_.path() + R"(/ball.urdf", position: [0, 0, 0.3]}
)",
                           resolver);
  ASSERT_EQ(scene.bodies.size(), 3u);
  for (const BodyDescription& body : scene.bodies) EXPECT_EQ(body.mass, 2.0);
  EXPECT_EQ(scene.bodies[0].source, folder_.path() + "/ball.urdf");
  EXPECT_NE(scene.bodies[1].source.find("/robot_description"), std::string::npos);
}

TEST_F(SceneFile, ADryTankNeedsNoMemory) {
  EXPECT_EQ(errorOf("tank: {size: [100, 100, 100], cell_width: 0.001}\n"), "no error");
  EXPECT_NE(errorOf("tank: {size: [100, 100, 100], cell_width: 0.001}\n"
                    "liquid: {boxes: [{min: [0, 0, 0], max: [1, 1, 1]}]}\n").find("memory"), std::string::npos);
}

TEST_F(SceneFile, OneDocumentMayBeMarkedAsSuch) {
  EXPECT_EQ(errorOf("---\n" + kTank + "...\n"), "no error");
  EXPECT_EQ(errorOf(kTank + "---\n"), "no error");
}

TEST_F(SceneFile, NamesInConflictWithOthersAreRefused) {
  SceneResolver resolver;
  resolver.name_conflict = [](const std::string& name) -> std::string { return name == "ball" ? "no ball" : ""; };
  EXPECT_NE(errorOf(kTank + kBody, resolver).find("scene.yaml:3: bodies[0].name: value ball: expected no ball"),
            std::string::npos) << errorOf(kTank + kBody, resolver);
  resolver.name_conflict = [](const std::string&) { return std::string(); };
  EXPECT_EQ(errorOf(kTank + kBody, resolver), "no error");
}

TEST_F(SceneFile, SizesWithinRoundOffOfWholeCellsBecomeExact) {
  const Scene scene = load(
      "tank: {size: [0.50000001, 0.7, 0.6], cell_width: 0.1}\n"
      "liquid: {fill_level: 0.6}\n");
  EXPECT_EQ(scene.tank.size, Vector3d(5 * 0.1, 7 * 0.1, 6 * 0.1));
}

TEST_F(SceneFile, MissingAndMalformedFilesAreNamed) {
  try {
    loadScene(folder_.path() + "/none.yaml", SceneResolver());
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("none.yaml: no such file"), std::string::npos);
  }
  expectError("tank:\n  size: [1, 2\nname: x\n", {"scene.yaml:3: malformed YAML"});
  expectError("a: b: c\n", {"scene.yaml:1: malformed YAML at column"});
  EXPECT_THROW(loadScene(folder_.path(), SceneResolver()), SceneError);
}

TEST(NearestWord, HasTheLeastEditDistance) {
  const std::vector<std::string> known = {"size", "origin", "cell_width", "periodic"};
  EXPECT_EQ(nearestWord("cellwidth", known), "cell_width");
  EXPECT_EQ(nearestWord("sizes", known), "size");
  EXPECT_EQ(nearestWord("orgin", known), "origin");
  EXPECT_EQ(nearestWord("perodik", known), "periodic");
  EXPECT_EQ(nearestWord("viscosity", {"density", "dynamic_viscosity"}), "dynamic_viscosity");
}

}  // namespace
}  // namespace monolith
