#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rigid/overlap.h"
#include "rigid_bodies.h"

namespace monolith {
namespace {

using Eigen::Vector3d;
using test::makeBody;
using test::pose;
using test::turn;

TankWalls unitTank() {
  TankWalls walls;
  walls.inside = Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d::Constant(1));
  return walls;
}

TEST(WallContacts, CountGapAndNormalOnEveryWall) {
  const Vector3d size(0.2, 0.2, 0.2);
  const struct {
    Shape shape;
    std::size_t least, most;
  } cases[] = {{test::boxShape(size), 4, 4},
               {test::sphereShape(0.1), 1, 1},
               {test::cylinderShape(0.1, 0.2), 2, 8},
               {test::boxMesh(size), 4, 4}};
  for (const auto& test_case : cases)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0})
        for (const double gap : {-0.004, 0.0, 0.004}) {
          Vector3d position = Vector3d::Constant(0.5);
          position[axis] = side < 0.0 ? 0.1 + gap : 0.9 - gap;
          const auto contacts = test::detect({makeBody("a", {test_case.shape}, pose(position))}, 0.01, unitTank());
          EXPECT_GE(contacts.size(), test_case.least);
          EXPECT_LE(contacts.size(), test_case.most);
          for (const Contact& contact : contacts) {
            EXPECT_EQ(contact.body_a, 0);
            EXPECT_EQ(contact.body_b, Contact::kWall);
            EXPECT_EQ(contact.normal, Vector3d(-side * Vector3d::Unit(axis)));
            EXPECT_NEAR(contact.gap, gap, 1e-12);
            EXPECT_NEAR(contact.point[axis], side < 0.0 ? gap : 1.0 - gap, 1e-12);
          }
          TankWalls periodic = unitTank();
          periodic.periodic[axis] = true;
          EXPECT_TRUE(test::detect({makeBody("a", {test_case.shape}, pose(position))}, 0.01, periodic).empty());
          const RigidBody fixed = makeBody("a", {test_case.shape}, pose(position), BodyMotion::kFixed);
          EXPECT_TRUE(test::detect({fixed}, 0.01, unitTank()).empty());
        }
}

TEST(WallContacts, CylinderStandsTiltsAndLies) {
  const Shape cylinder = test::cylinderShape(0.1, 0.3);
  const auto at = [&](double degrees, double height) {
    const auto X_WB = pose(Vector3d(0.5, 0.5, height), turn(degrees, Vector3d(1, 2, 0)));
    return test::detect({makeBody("a", {cylinder}, X_WB)}, 0.01, unitTank());
  };
  const auto stands = at(0.0, 0.15);
  EXPECT_EQ(stands.size(), 8u);
  EXPECT_TRUE(test::supports(stands, Vector3d(0.56, 0.5, 0)));
  EXPECT_EQ(at(90.0, 0.1).size(), 2u);
  for (const double degrees : {1e-3, 3.0, 30.0, 60.0, 89.9, 120.0}) {
    const double angle = degrees * M_PI / 180.0;
    const double reach = 0.15 * std::abs(std::cos(angle)) + 0.1 * std::sin(angle);
    EXPECT_NEAR(test::leastGap(at(degrees, reach + 0.003)), 0.003, 1e-12) << degrees;
  }
}

// Of many vertices in reach those that carry the ring are kept all around it, though it leans a little: if those of one
// side were missing it would rock from side to side for ever.
TEST(WallContacts, LeaningRingIsCarriedAllAround) {
  const double radius = 0.03, tube = 0.015, lean = 1e-3;
  const Shape ring = test::ringMesh(radius, tube, 32, 32);
  const auto X_WB = pose(Vector3d(0.5, 0.5, tube + 5e-5), turn(lean * 180.0 / M_PI, Vector3d(3, 4, 0)));
  std::vector<double> angles;
  for (const Contact& contact : test::detect({makeBody("ring", {ring}, X_WB)}, 0.008, unitTank())) {
    if (contact.gap > 5e-5 + 1.1 * lean * radius) continue;
    angles.push_back(std::atan2(contact.point[1] - 0.5, contact.point[0] - 0.5));
  }
  ASSERT_GE(angles.size(), 6u);
  std::sort(angles.begin(), angles.end());
  angles.push_back(angles.front() + 2.0 * M_PI);
  double widest = 0.0;
  for (std::size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
  EXPECT_LT(widest, M_PI / 3.0);
}

TEST(Overlaps, NoneAmongTouchingBodies) {
  const Shape box = test::boxShape(Vector3d::Constant(0.2));
  const std::vector<RigidBody> bodies{
      makeBody("low", {box}, pose(Vector3d(0.5, 0.5, 0.1))), makeBody("high", {box}, pose(Vector3d(0.5, 0.5, 0.3))),
      makeBody("mesh", {test::boxMesh(Vector3d::Constant(0.2))}, pose(Vector3d(0.7, 0.5, 0.1))),
      makeBody("ball", {test::sphereShape(0.1)}, pose(Vector3d(0.5, 0.5, 0.5)))};
  EXPECT_EQ(describeOverlaps(bodies, unitTank(), 1e-9), "");
}

TEST(Overlaps, NamesBodiesAndDepth) {
  const Shape box = test::boxShape(Vector3d::Constant(0.2));
  const std::string lines = describeOverlaps({makeBody("left", {box}, pose(Vector3d(0.3, 0.5, 0.5))),
                                              makeBody("right", {box}, pose(Vector3d(0.48, 0.52, 0.5)))},
                                             unitTank(), 1e-3);
  EXPECT_EQ(lines, "bodies 'left' and 'right' overlap by 0.02 m\n");
}

TEST(Overlaps, AcrossThePeriodicBoundary) {
  const Shape box = test::boxShape(Vector3d::Constant(0.2));
  TankWalls walls = unitTank();
  const std::vector<RigidBody> bodies{makeBody("left", {box}, pose(Vector3d(0.05, 0.98, 0.5))),
                                      makeBody("right", {box}, pose(Vector3d(0.9, 0.01, 0.5)))};
  walls.periodic[0] = true;
  EXPECT_EQ(describeOverlaps(bodies, walls, 1e-3).find("overlap"), std::string::npos);
  walls.periodic[1] = true;
  const std::string expected = "bodies 'left' and 'right' overlap by 0.05 m, across the periodic boundary\n";
  EXPECT_EQ(describeOverlaps(bodies, walls, 1e-3), expected);
  EXPECT_EQ(describeOverlaps(bodies, walls, 1e-3, 1), expected);
  EXPECT_EQ(describeOverlaps(bodies, walls, 0.06), "");
}

TEST(Overlaps, FindsFullContainment) {
  const Shape small[] = {test::sphereShape(0.02), test::boxShape(Vector3d::Constant(0.03)),
                         test::cylinderShape(0.02, 0.03), test::boxMesh(Vector3d::Constant(0.03))};
  const Shape large[] = {test::sphereShape(0.3), test::boxShape(Vector3d::Constant(0.6)), test::cylinderShape(0.3, 0.6),
                         test::boxMesh(Vector3d::Constant(0.6))};
  for (const Shape& inner : small)
    for (const Shape& outer : large)
      for (const bool first : {false, true}) {
        std::vector<RigidBody> bodies{makeBody("inner", {inner}, pose(Vector3d(0.52, 0.5, 0.5))),
                                      makeBody("outer", {outer}, pose(Vector3d::Constant(0.5)))};
        if (first) std::swap(bodies[0], bodies[1]);
        const std::string lines = describeOverlaps(bodies, unitTank(), 0.2);
        EXPECT_NE(lines.find("'inner'"), std::string::npos)
            << static_cast<int>(inner.kind) << " in " << static_cast<int>(outer.kind);
      }
}

TEST(Overlaps, FindsCrossingBarsWithoutCornersInside) {
  const Vector3d size(0.8, 0.1, 0.1);
  for (const bool mesh_a : {false, true})
    for (const bool mesh_b : {false, true}) {
      const std::string lines = describeOverlaps(
          {makeBody("a", {mesh_a ? test::boxMesh(size) : test::boxShape(size)}, pose(Vector3d::Constant(0.5))),
           makeBody("b", {mesh_b ? test::boxMesh(size) : test::boxShape(size)},
                    pose(Vector3d(0.5, 0.5, 0.54), turn(90.0, Vector3d::UnitZ())))},
          unitTank(), 0.01);
      EXPECT_NE(lines.find("'a' and 'b'"), std::string::npos) << mesh_a << mesh_b;
    }
}

TEST(Overlaps, NamesTheWall) {
  const Shape shape = test::boxShape(Vector3d::Constant(0.2));
  EXPECT_EQ(
      describeOverlaps({makeBody("box", {shape}, pose(Vector3d(0.95, 0.5, 0.08)))}, unitTank(), 1e-3),
      "body 'box' sticks out of the tank's wall +x by 0.05 m\nbody 'box' sticks out of the tank's wall -z by 0.02 m\n");
  TankWalls periodic = unitTank();
  periodic.periodic[0] = true;
  EXPECT_EQ(describeOverlaps({makeBody("box", {shape}, pose(Vector3d(0.95, 0.5, 0.5)))}, periodic, 1e-3), "");
}

}  // namespace
}  // namespace monolith
