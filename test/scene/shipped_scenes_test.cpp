// Every scene and URDF that ships: it loads, its masses are those of the stated density, nothing overlaps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <sstream>

#include "geometry/shape.h"
#include "scene/resource_path.h"
#include "scene/scene_file.h"
#include "scene/urdf_body.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const fs::path kSource = MONOLITH_SOURCE_DIR;

Scene scene(const std::string& name) {
  return loadScene((kSource / "config/scenes" / (name + ".yaml")).string(), SceneResolver());
}

// Inertia about the centre of mass of a solid of unit density. A mesh is summed over the tetrahedra between its
// triangles and the origin.
Matrix3d unitInertia(const Shape& shape) {
  const double v = volume(shape);
  const auto fromMoments = [](const Vector3d& m) { return Matrix3d((Vector3d::Constant(m.sum()) - m).asDiagonal()); };
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return fromMoments(v / 12.0 * shape.box_size.cwiseProduct(shape.box_size));
    case Shape::Kind::kSphere:
      return fromMoments(Vector3d::Constant(v / 5.0 * shape.radius * shape.radius));
    case Shape::Kind::kCylinder: {
      const double across = v / 4.0 * shape.radius * shape.radius;
      return fromMoments(Vector3d(across, across, v / 12.0 * shape.length * shape.length));
    }
    case Shape::Kind::kMesh:
      break;
  }
  Matrix3d second = Matrix3d::Zero();
  Vector3d first = Vector3d::Zero();
  for (const Eigen::Vector3i& t : shape.mesh->triangles) {
    Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = shape.mesh->vertices[t[i]];
    const double six_volume = corners.determinant();
    const Vector3d sum = corners.rowwise().sum();
    first += six_volume / 24.0 * sum;
    second += six_volume / 120.0 * (corners * corners.transpose() + sum * sum.transpose());
  }
  second -= first * first.transpose() / v;
  return second.trace() * Matrix3d::Identity() - second;
}

TEST(ShippedUrdfs, MassAndInertiaAreThoseOfTheDensity) {
  const std::map<std::string, double> densities = {
      {"steel_sphere", 7800}, {"aluminium_box", 2700},  {"torus", 1500},        {"light_ball", 100},
      {"wood_cylinder", 900}, {"tencate_sphere", 1120}, {"stack_bottom", 1500}, {"stack_middle", 2500},
      {"stack_top", 8000},    {"two_link_arm", 2700}};
  std::size_t found = 0;
  for (const auto& entry : fs::directory_iterator(kSource / "urdf")) {
    if (entry.path().extension() != ".urdf") continue;
    const auto density = densities.find(entry.path().stem().string());
    ASSERT_NE(density, densities.end()) << entry.path() << " has no density in this test";
    std::vector<BodyDescription> bodies;
    const std::string xml = readTextFile(entry.path().string());
    const auto errors =
        readUrdfBodies({entry.path().string(), (kSource / "urdf").string(), xml}, SceneResolver(), bodies);
    ASSERT_TRUE(errors.empty()) << errors.front();
    for (const BodyDescription& body : bodies) {
      ASSERT_EQ(body.shapes.size(), 1u);
      const Shape& shape = body.shapes[0];
      EXPECT_NEAR(body.mass, density->second * volume(shape), 1e-6 * body.mass) << entry.path();
      EXPECT_TRUE(shape.X_BG.linear().isIdentity(0.0));
      const Matrix3d inertia = density->second * unitInertia(shape);
      EXPECT_LT((body.inertia_Bcm - inertia).norm(), 1e-5 * inertia.norm()) << entry.path();
      EXPECT_LT((body.p_BBcm - shape.X_BG.translation()).norm(), 1e-12);
    }
    EXPECT_LT(bodies[0].p_BBcm.norm(), 1e-12);
    EXPECT_NE(xml.find("<visual>"), std::string::npos);
    EXPECT_NE(xml.find("<color"), std::string::npos);
    EXPECT_NE(xml.find(std::to_string(static_cast<int>(density->second)) + " kg/m^3"), std::string::npos);
    ++found;
  }
  EXPECT_EQ(found, densities.size());
}

void expectNoOverlap(const Scene& scene) {
  std::vector<std::shared_ptr<const SignedDistance>> fields;
  for (const BodyDescription& body : scene.bodies) fields.push_back(makeSignedDistance(body.shapes, 0.005));
  std::mt19937 engine(6);
  for (int i = 0; i < 200000; ++i) {
    Vector3d p_W = scene.tank.origin;
    for (int axis = 0; axis < 3; ++axis) p_W[axis] += scene.tank.size[axis] * (engine() / 4294967296.0);
    int inside = 0;
    for (std::size_t b = 0; b < fields.size(); ++b) {
      inside += fields[b]->distance(scene.bodies[b].X_WB.inverse() * p_W) < 0.0;
    }
    ASSERT_LE(inside, 1) << scene.source << " at " << p_W.transpose();
  }
}

TEST(ShippedScenes, AllLoadWithoutOverlap) {
  int found = 0;
  for (const auto& entry : fs::directory_iterator(kSource / "config/scenes")) {
    const Scene scene = loadScene(entry.path().string(), SceneResolver());
    EXPECT_EQ(scene.name, entry.path().stem().string());
    expectNoOverlap(scene);
    ++found;
  }
  EXPECT_GE(found, 4);
}

TEST(ShippedScenes, DropFallsIntoAHalfFilledTank) {
  const Scene drop = scene("drop");
  EXPECT_EQ(drop.tank.size, Vector3d::Constant(32 * 0.01));
  EXPECT_DOUBLE_EQ(drop.liquid.fill_level, 0.5 * drop.tank.size.z());
  std::map<Shape::Kind, int> kinds;
  for (const BodyDescription& body : drop.bodies) {
    for (const Shape& shape : body.shapes) {
      ++kinds[shape.kind];
      EXPECT_GT(bounds(shape, body.X_WB).min().z(), drop.liquid.fill_level) << body.name;
    }
  }
  EXPECT_GE(kinds[Shape::Kind::kSphere], 2);
  EXPECT_GE(kinds[Shape::Kind::kBox], 1);
  EXPECT_GE(kinds[Shape::Kind::kMesh], 1);
}

TEST(ShippedScenes, ArmStirsFromRestBesideABallThatFloats) {
  const Scene arm = scene("arm");
  EXPECT_DOUBLE_EQ(arm.liquid.fill_level, 0.5 * arm.tank.size.z());
  ASSERT_EQ(arm.bodies.size(), 4u);
  EXPECT_EQ(arm.bodies[0].motion, BodyMotion::kFixed);
  const JointDescription &shoulder = *arm.bodies[1].joint, &elbow = *arm.bodies[2].joint;
  EXPECT_GT(shoulder.servo.stiffness, 0.0);
  const PrescribedJointMotion& swing = elbow.prescribed.value();
  EXPECT_NEAR(swing.rate + swing.amplitude * std::cos(swing.phase), 0.0, 1e-12);
  // To the other side, within the joint's range, and back.
  EXPECT_NEAR(elbow.position - 2.0 * swing.amplitude * std::sin(swing.phase), -elbow.position, 1e-12);
  EXPECT_LT(std::abs(elbow.position), elbow.upper);
  const Eigen::AlignedBox3d lower = bounds(arm.bodies[2].shapes[0], arm.bodies[2].X_WB);
  EXPECT_LT(lower.min().z(), arm.liquid.fill_level - 4.0 * arm.tank.cell_width);
  // A cap of this depth displaces as much liquid as it weighs.
  const BodyDescription& ball = arm.bodies[3];
  const double radius = ball.shapes[0].radius;
  const double depth = arm.liquid.fill_level - (ball.X_WB.translation().z() - radius);
  EXPECT_NEAR(arm.liquid.density * M_PI / 3.0 * depth * depth * (3.0 * radius - depth), ball.mass, 0.05 * ball.mass);
}

TEST(ShippedScenes, SettlingSphereIsCaseE1) {
  const Scene e1 = scene("settling_sphere");
  EXPECT_LT((e1.tank.size - Vector3d(0.1, 0.1, 0.16)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(e1.liquid.fill_level, 0.16);
  EXPECT_EQ(e1.liquid.density, 970.0);
  EXPECT_EQ(e1.liquid.dynamic_viscosity, 0.373);
  ASSERT_EQ(e1.bodies.size(), 1u);
  const BodyDescription& sphere = e1.bodies[0];
  EXPECT_NEAR(2.0 * sphere.shapes[0].radius / e1.tank.cell_width, 6.0, 1e-12);
  EXPECT_NEAR(bounds(sphere.shapes[0], sphere.X_WB).min().z(), 0.12, 1e-12);
  EXPECT_NEAR(sphere.mass, 1120.0 * M_PI / 6.0 * std::pow(0.015, 3), 1e-9);
}

TEST(ShippedScenes, StackIsUnderLiquidWithTheHeaviestOnTop) {
  const Scene stack = scene("stack");
  ASSERT_EQ(stack.bodies.size(), 3u);
  double below = stack.tank.origin.z();
  double lighter = 0.0;
  for (const BodyDescription& body : stack.bodies) {
    const Eigen::AlignedBox3d box = bounds(body.shapes[0], body.X_WB);
    EXPECT_NEAR(box.min().z(), below + 5e-5, 6e-5);
    EXPECT_GT(body.mass, lighter);
    below = box.max().z();
    lighter = body.mass;
  }
  EXPECT_LT(below, stack.liquid.fill_level);
}

TEST(SceneTemplate, LoadsAndNamesEveryKey) {
  const std::string file = (kSource / "config/scene_template.yaml").string();
  const Scene scene = loadScene(file, SceneResolver());
  std::vector<std::string> names;
  for (const BodyDescription& body : scene.bodies) names.push_back(body.name);
  EXPECT_EQ(names, (std::vector<std::string>{"ball", "paddle", "arm", "arm/upper", "arm/lower"}));
  expectNoOverlap(scene);
  const std::string text = readTextFile(file);
  for (const char* key : {"size:",
                          "origin:",
                          "cell_width:",
                          "periodic:",
                          "density:",
                          "dynamic_viscosity:",
                          "fill_level:",
                          "boxes:",
                          "min:",
                          "max:",
                          "gravity:",
                          "time_step:",
                          "tolerance:",
                          "maximum_iterations:",
                          "threads:",
                          "cfl:",
                          "name:",
                          "urdf:",
                          "urdf_parameter:",
                          "position:",
                          "rpy:",
                          "quaternion:",
                          " velocity:",
                          "angular_velocity:",
                          "orientation:",
                          "material:",
                          "prescribed:",
                          "in_place:",
                          "rheology:",
                          "contact:",
                          "friction:",
                          "restitution:",
                          "pairs:",
                          "between:",
                          "coupling:",
                          "discretisation:",
                          "time_stepping:",
                          "motion:",
                          "self_collision:",
                          "joints:",
                          "stiffness:",
                          "damping:",
                          "rate:",
                          "twist:",
                          "amplitude:",
                          "frequency:",
                          "phase:"}) {
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
}

// What the template's comment over the line that begins like this says is the default.
std::string statedDefault(const std::string& text, const std::string& line) {
  const auto at = text.find("\n" + line + ":");
  const std::string mark = "Default: ";
  const auto begin = text.rfind(mark, at);
  const auto end = text.find('\n', begin);
  if (at == std::string::npos || begin == std::string::npos) return "no such line: " + line;
  std::istringstream between(text.substr(end, at - end));
  for (std::string other; std::getline(between, other);) {
    if (!other.empty() && other.find('#') == std::string::npos) return "none is stated of " + line;
  }
  std::string stated = text.substr(begin + mark.size(), end - begin - mark.size());
  stated.resize(std::min(stated.size(), stated.find(". ")));
  if (!stated.empty() && stated.back() == '.') stated.pop_back();
  return stated;
}

// A scene that states the template's defaults is the one that leaves them out.
TEST(SceneTemplate, DefaultsItStatesAreThoseOfTheCode) {
  const std::string text = readTextFile((kSource / "config/scene_template.yaml").string());
  const auto lines = [&](const std::string& indent, const std::vector<std::string>& keys) {
    std::string out;
    for (const std::string& key : keys) out += indent + key + ": " + statedDefault(text, indent + key) + "\n";
    return out;
  };
  const std::string least =
      "tank: {size: [0.4, 0.3, 0.3], origin: [-0.2, -0.15, -0.1], cell_width: 0.02}\nbodies:\n  - name: ball\n    "
      "urdf: " +
      (kSource / "urdf/steel_sphere.urdf").string() + "\n";
  const auto arm = [](const std::string& keys) {
    return "  - name: arm\n    urdf: " + (kSource / "urdf/two_link_arm.urdf").string() +
           "\n    position: [0, 0, 0.18]\n    " + keys + "\n";
  };
  const std::string friction = statedDefault(text, "  friction");  // and restitution
  const std::string all =
      least + lines("    ", {"position", "velocity", "angular_velocity", "motion"}) + "    orientation: {" +
      statedDefault(text, "    orientation") + "}\n" +
      arm("self_collision: " + statedDefault(text, "    self_collision") + "\n    joints:\n      shoulder:\n" +
          lines("        ", {"position", "velocity", "stiffness", "damping"}) + "      elbow:\n        prescribed:\n" +
          lines("          ", {"rate", "amplitude", "frequency", "phase"})) +
      lines("", {"gravity", "time_step"}) + "contact: {friction: " + friction + ", restitution: " + friction +
      "}\nliquid:\n" + lines("  ", {"density", "dynamic_viscosity", "fill_level"}) + "solver:\n" +
      lines("  ", {"name", "coupling", "discretisation", "time_stepping", "tolerance", "maximum_iterations", "threads",
                   "cfl"});
  const TemporaryFolder folder;
  const auto load = [&](const std::string& yaml) {
    return loadScene(folder.write("scene.yaml", yaml), SceneResolver());
  };
  SCOPED_TRACE(all);
  Scene stated, omitted;
  ASSERT_NO_THROW(stated = load(all));
  omitted = load(least + arm("joints: {elbow: {prescribed: {}}}"));
  EXPECT_EQ(stated.liquid.density, omitted.liquid.density);
  EXPECT_EQ(stated.liquid.dynamic_viscosity, omitted.liquid.dynamic_viscosity);
  EXPECT_EQ(stated.liquid.fill_level, omitted.liquid.fill_level);
  EXPECT_EQ(stated.gravity, omitted.gravity);
  EXPECT_EQ(stated.time_step, omitted.time_step);
  EXPECT_EQ(stated.contact.friction, omitted.contact.friction);
  EXPECT_EQ(stated.contact.restitution, omitted.contact.restitution);
  EXPECT_EQ(stated.solver.name, omitted.solver.name);
  EXPECT_EQ(stated.solver.coupling, omitted.solver.coupling);
  EXPECT_EQ(stated.solver.discretisation, omitted.solver.discretisation);
  EXPECT_EQ(stated.solver.time_stepping, omitted.solver.time_stepping);
  EXPECT_EQ(stated.solver.tolerance, omitted.solver.tolerance);
  EXPECT_EQ(stated.solver.maximum_iterations, omitted.solver.maximum_iterations);
  EXPECT_EQ(stated.solver.threads, omitted.solver.threads);
  EXPECT_EQ(stated.solver.cfl, omitted.solver.cfl);
  const BodyDescription &told = stated.bodies.at(0), &untold = omitted.bodies.at(0);
  EXPECT_EQ(told.X_WB.matrix(), untold.X_WB.matrix());
  EXPECT_EQ(told.velocity, untold.velocity);
  EXPECT_EQ(told.angular_velocity, untold.angular_velocity);
  EXPECT_EQ(told.motion, untold.motion);
  ASSERT_EQ(stated.bodies.size(), omitted.bodies.size());
  EXPECT_EQ(stated.bodies.at(1).self_collision, omitted.bodies.at(1).self_collision);
  const JointDescription &shoulder = *stated.bodies.at(2).joint, &untold_shoulder = *omitted.bodies.at(2).joint;
  EXPECT_EQ(shoulder.position, untold_shoulder.position);
  EXPECT_EQ(shoulder.velocity, untold_shoulder.velocity);
  EXPECT_EQ(shoulder.servo.stiffness, untold_shoulder.servo.stiffness);
  EXPECT_EQ(shoulder.servo.damping, untold_shoulder.servo.damping);
  const PrescribedJointMotion &elbow = *stated.bodies.at(3).joint->prescribed,
                              &untold_elbow = *omitted.bodies.at(3).joint->prescribed;
  EXPECT_EQ(elbow.rate, untold_elbow.rate);
  EXPECT_EQ(elbow.amplitude, untold_elbow.amplitude);
  EXPECT_EQ(elbow.frequency, untold_elbow.frequency);
  EXPECT_EQ(elbow.phase, untold_elbow.phase);
}

}  // namespace
}  // namespace monolith
