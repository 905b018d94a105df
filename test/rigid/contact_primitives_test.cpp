#include <gtest/gtest.h>

#include <cmath>

#include "rigid/convex_separation.h"
#include "rigid_bodies.h"

namespace monolith {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::boxShape;
using test::cylinderShape;
using test::detectPair;
using test::pose;
using test::sphereShape;
using test::turn;

void expectAll(const std::vector<Contact>& contacts, const Vector3d& normal, double gap) {
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.body_a, 0);
    EXPECT_EQ(contact.body_b, 1);
    EXPECT_LT((contact.normal - normal).norm(), 1e-9);
    EXPECT_NEAR(contact.gap, gap, 1e-9);
  }
}

// Box a on box b, both with sides 1 and 0.2 m high, turned by the angle; gaps from apart to deep.
class BoxOnBox : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(BoxOnBox, GivesTheWholeSupportPolygon) {
  const auto [degrees, gap] = GetParam();
  const Shape box = boxShape(Vector3d(1, 1, 0.2));
  const Quaterniond q = turn(degrees, Vector3d::UnitZ());
  const auto contacts = detectPair(box, pose(Vector3d(0, 0, 0.2 + gap), q), box, pose(Vector3d::Zero()), 0.02);
  EXPECT_EQ(contacts.size(), degrees == 0.0 ? 4u : 8u);
  expectAll(contacts, Vector3d::UnitZ(), gap);
  EXPECT_TRUE(test::supports(contacts, Vector3d::Zero()));
  // The overlap of two unit squares, turned, reaches as far as its corners, where sides cross.
  const double half_angle = 0.5 * degrees * M_PI / 180.0;
  for (const Contact& contact : contacts) {
    const double radius = contact.point.head<2>().norm();
    const double one = 0.5 / std::cos(M_PI / 4 - half_angle), other = 0.5 / std::cos(half_angle);
    EXPECT_LT(std::min(std::abs(radius - one), degrees == 0.0 ? 1.0 : std::abs(radius - other)), 1e-9);
    EXPECT_NEAR(contact.point.z(), 0.1 + 0.5 * gap, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(AnglesAndGaps, BoxOnBox,
                         ::testing::Combine(::testing::Values(0.0, 30.0, 45.0),
                                            ::testing::Values(-0.01, -1e-7, 0.0, 1e-7, 0.015)));

TEST(BoxContacts, OverhangIsSupportedUpToTheEdge) {
  const Shape box = boxShape(Vector3d(1, 1, 1));
  for (const double degrees : {0.0, 30.0, 45.0}) {
    const auto contacts =
        detectPair(box, pose(Vector3d(0.6, 0, 1), turn(degrees, Vector3d::UnitZ())), box, pose(Vector3d::Zero()), 0.01);
    double farthest = -1.0;
    for (const Contact& contact : contacts) farthest = std::max(farthest, contact.point.x());
    EXPECT_NEAR(farthest, 0.5, 1e-9) << degrees;
    EXPECT_GE(contacts.size(), 3u);
    // Its centre of mass is beyond the edge: it must be free to fall.
    EXPECT_FALSE(test::supports(contacts, Vector3d(0.6, 0, 0)));
    expectAll(contacts, Vector3d::UnitZ(), 0.0);
  }
}

TEST(BoxContacts, FlushStackHasNoSidewaysNormal) {
  const Shape box = boxShape(Vector3d(1, 1, 1));
  for (const double shift : {-1e-6, -1e-9, 0.0, 1e-9, 1e-6})
    for (const double gap : {-1e-6, -1e-9, 0.0, 1e-9, 1e-6}) {
      const auto contacts =
          detectPair(box, pose(Vector3d(shift, 2 * shift, 1 + gap)), box, pose(Vector3d::Zero()), 0.01);
      EXPECT_EQ(contacts.size(), 4u);
      expectAll(contacts, Vector3d::UnitZ(), gap);
    }
}

TEST(BoxContacts, EdgeAcrossEdge) {
  const Shape bar = boxShape(Vector3d(2, 0.2, 0.2));
  const double diagonal = 0.1 * std::sqrt(2.0);
  const Quaterniond roll = turn(45.0, Vector3d::UnitX());
  for (const double gap : {-0.02, 0.0, 0.01}) {
    const auto contacts = detectPair(bar, pose(Vector3d(0, 0, 2 * diagonal + gap), roll), bar,
                                     pose(Vector3d::Zero(), turn(90.0, Vector3d::UnitZ()) * roll), 0.02);
    ASSERT_EQ(contacts.size(), 1u);
    expectAll(contacts, Vector3d::UnitZ(), gap);
    EXPECT_LT((contacts[0].point - Vector3d(0, 0, diagonal + 0.5 * gap)).norm(), 1e-9);
  }
}

TEST(BoxContacts, CornerAndEdgeOnFace) {
  const Shape box = boxShape(Vector3d(1, 1, 1));
  const Shape table = boxShape(Vector3d(4, 4, 1));
  const auto edge = detectPair(box, pose(Vector3d(0, 0, 0.5 + std::sqrt(0.5)), turn(45.0, Vector3d::UnitX())), table,
                               pose(Vector3d::Zero()), 0.01);
  EXPECT_EQ(edge.size(), 2u);
  expectAll(edge, Vector3d::UnitZ(), 0.0);
  const Quaterniond on_corner = Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), Vector3d(0, 0, -1));
  const auto corner = detectPair(box, pose(Vector3d(0, 0, 0.5 + std::sqrt(0.75) - 0.003), on_corner), table,
                                 pose(Vector3d::Zero()), 0.01);
  EXPECT_EQ(corner.size(), 1u);
  expectAll(corner, Vector3d::UnitZ(), -0.003);
}

// What two surfaces have in common is bounded by both, also where their planes are one but for round-off.
TEST(BoxContacts, OfBoxesOnOneFloorLieBetweenThem) {
  const Shape box = boxShape(Vector3d(0.2, 0.2, 0.2));
  int found = 0;
  for (int i = -20; i <= 20; ++i) {
    for (const double tilt : {0.0, 1e-9, 2e-9, 1e-8}) {
      const Eigen::Isometry3d X_WA = pose(Vector3d(-0.207, 0.01, 0.1e-9 * i),
                                          turn(3.0, Vector3d::UnitZ()) * turn(tilt / M_PI * 180.0, Vector3d::UnitX()));
      for (const Contact& contact : detectPair(box, X_WA, box, pose(Vector3d::Zero()), 0.02)) {
        ++found;
        EXPECT_LT(contact.point.cwiseAbs()[1], 0.12) << i;
        EXPECT_LT(contact.point.cwiseAbs()[2], 0.11) << i;
        EXPECT_GT(contact.gap, 0.0) << i;
      }
    }
  }
  EXPECT_GT(found, 100);
}

TEST(CylinderContacts, StandsOnManyRimPoints) {
  const Shape cylinder = cylinderShape(0.3, 1.0);
  for (const double gap : {-0.004, 0.0, 0.004}) {
    const auto contacts =
        detectPair(cylinder, pose(Vector3d(0, 0, 1 + gap)), boxShape(Vector3d(2, 2, 1)), pose(Vector3d::Zero()), 0.01);
    EXPECT_EQ(contacts.size(), 8u);
    expectAll(contacts, Vector3d::UnitZ(), gap);
    for (const Contact& contact : contacts) EXPECT_NEAR(contact.point.head<2>().norm(), 0.3, 1e-9);
    EXPECT_TRUE(test::supports(contacts, Vector3d(0.2, 0.1, 0)));
  }
}

TEST(CylinderContacts, LiesOnTwoEnds) {
  const Shape cylinder = cylinderShape(0.3, 1.0);
  const auto contacts = detectPair(cylinder, pose(Vector3d(0, 0, 0.802), turn(90.0, Vector3d::UnitX())),
                                   boxShape(Vector3d(2, 2, 1)), pose(Vector3d::Zero()), 0.01);
  ASSERT_EQ(contacts.size(), 2u);
  expectAll(contacts, Vector3d::UnitZ(), 0.002);
  EXPECT_NEAR((contacts[0].point - contacts[1].point).norm(), 1.0, 1e-9);
}

TEST(CylinderContacts, TiltedStandsOnItsLowestRimPoint) {
  const double angle = 20.0 * M_PI / 180.0;
  const double reach = 0.5 * std::cos(angle) + 0.3 * std::sin(angle);
  const Quaterniond q = turn(7.0, Vector3d::UnitZ()) * turn(20.0, Vector3d::UnitX());
  const auto contacts = detectPair(cylinderShape(0.3, 1.0), pose(Vector3d(0, 0, 0.5 + reach + 0.001), q),
                                   boxShape(Vector3d(2, 2, 1)), pose(Vector3d::Zero()), 0.004);
  ASSERT_FALSE(contacts.empty());
  EXPECT_NEAR(test::leastGap(contacts), 0.001, 1e-9);
}

TEST(CylinderContacts, SideBySideAndCrossed) {
  const Shape cylinder = cylinderShape(0.3, 1.0);
  const auto parallel = detectPair(cylinder, pose(Vector3d(0.6, 0, 0.25)), cylinder, pose(Vector3d::Zero()), 0.01);
  EXPECT_EQ(parallel.size(), 2u);
  expectAll(parallel, Vector3d::UnitX(), 0.0);
  EXPECT_NEAR(std::abs(parallel[0].point.z() - parallel[1].point.z()), 0.75, 1e-9);
  const auto crossed = detectPair(cylinder, pose(Vector3d(0.605, 0, 0), turn(90.0, Vector3d::UnitX())), cylinder,
                                  pose(Vector3d::Zero()), 0.01);
  EXPECT_EQ(crossed.size(), 1u);
  expectAll(crossed, Vector3d::UnitX(), 0.005);
}

// A cylinder's side across a box's edge: over the face lies only what is farther off.
TEST(CylinderContacts, NothingIsNearerThanTheContacts) {
  test::Random random(11);
  const Shape cylinder = cylinderShape(0.2, 0.5), box = boxShape(Vector3d(0.5, 0.3, 0.4));
  int near = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Eigen::Isometry3d X_WA = pose(random.inCube(0.6), random.rotation()), X_WB = pose(Vector3d::Zero());
    const double distance = findSeparation(placeConvex(cylinder, X_WA), placeConvex(box, X_WB)).distance;
    if (std::abs(distance) > 0.02) continue;
    ++near;
    double least = 1e300;
    for (const Contact& contact : detectPair(cylinder, X_WA, box, X_WB, 0.03)) least = std::min(least, contact.gap);
    EXPECT_LT(least, distance + 1e-3) << trial;
  }
  EXPECT_GT(near, 500);
}

TEST(CylinderContacts, StacksOnACylinder) {
  const Shape cylinder = cylinderShape(0.3, 1.0);
  const auto contacts = detectPair(cylinder, pose(Vector3d(0.1, 0, 1)), cylinder, pose(Vector3d::Zero()), 0.01);
  EXPECT_EQ(contacts.size(), 8u);
  expectAll(contacts, Vector3d::UnitZ(), 0.0);
  EXPECT_TRUE(test::supports(contacts, Vector3d(0.05, 0, 0)));
  EXPECT_TRUE(test::supports(contacts, Vector3d(0.05, 0.2, 0)));
}

TEST(SphereContacts, OnEveryPrimitive) {
  const Shape sphere = sphereShape(0.5);
  for (const double gap : {-0.02, 0.0, 0.01}) {
    const auto pose_a = pose(Vector3d(0, 0, 1 + gap), turn(30.0, Vector3d(1, 2, 3)));
    for (const Shape& other : {sphereShape(0.5), boxShape(Vector3d(2, 2, 1)), cylinderShape(0.7, 1.0)}) {
      const auto contacts = detectPair(sphere, pose_a, other, pose(Vector3d::Zero()), 0.02);
      ASSERT_EQ(contacts.size(), 1u);
      expectAll(contacts, Vector3d::UnitZ(), gap);
      EXPECT_LT((contacts[0].point - Vector3d(0, 0, 0.5 + 0.5 * gap)).norm(), 1e-9);
    }
  }
  // Inside a larger box, nearest to its side.
  const auto inside =
      detectPair(sphere, pose(Vector3d(1.0, 0, 0)), boxShape(Vector3d(4, 4, 4)), pose(Vector3d::Zero()), 0.01);
  ASSERT_EQ(inside.size(), 1u);
  expectAll(inside, Vector3d::UnitX(), -1.5);
}

TEST(Contacts, FixedAndPrescribedPairsGiveNone) {
  const Shape box = boxShape(Vector3d(1, 1, 1));
  for (const BodyMotion a : {BodyMotion::kFixed, BodyMotion::kPrescribed}) {
    std::vector<RigidBody> bodies{test::makeBody("a", {box}, pose(Vector3d(0, 0, 1)), a),
                                  test::makeBody("b", {box}, pose(Vector3d::Zero()), BodyMotion::kFixed)};
    TankWalls walls;
    walls.inside = Eigen::AlignedBox3d(Vector3d(-0.5, -0.5, -0.5), Vector3d(2, 2, 2));
    EXPECT_TRUE(test::detect(bodies, 0.01, walls).empty());
    bodies[0].motion = BodyMotion::kFree;
    EXPECT_FALSE(test::detect(bodies, 0.01).empty());
  }
}

// Oracle: every primitive's surface sampled densely against the other's exact distance. The samples are on the
// surface, so their least distance is never below the true one, and above it by at most what the spacing allows.
std::vector<Vector3d> surfaceSamples(const ConvexShape& shape, int n) {
  std::vector<Vector3d> points;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        Vector3d p;
        p[face / 2] = face % 2 ? 1.0 : -1.0;
        p[(face / 2 + 1) % 3] = -1.0 + 2.0 * i / n;
        p[(face / 2 + 2) % 3] = -1.0 + 2.0 * j / n;
        if (shape.kind == Shape::Kind::kBox) {
          points.push_back(shape.X_WG * Vector3d(p.cwiseProduct(shape.half)));
        } else {  // the cube's surface pressed onto the cylinder's
          const double square = p.head<2>().cwiseAbs().maxCoeff(), round = p.head<2>().norm();
          if (round > 0.0) p.head<2>() *= square / round;
          points.push_back(shape.X_WG *
                           Vector3d(shape.radius * p.x(), shape.radius * p.y(), shape.half_length * p.z()));
        }
      }
  return points;
}

TEST(Separation, AgreesWithDenseSampling) {
  test::Random random(7);
  const int n = 60;
  for (int trial = 0; trial < 60; ++trial) {
    const Shape box = boxShape(Vector3d(0.5, 0.3, 0.4)), cylinder = cylinderShape(0.2, 0.5);
    const ConvexShape a = placeConvex(trial % 2 ? box : cylinder, pose(random.inCube(0.5), random.rotation()));
    const ConvexShape b = placeConvex(trial % 3 ? box : cylinder, pose(random.inCube(0.1), random.rotation()));
    double least = 1e300;
    for (const Vector3d& p : surfaceSamples(a, n)) least = std::min(least, sampleDistance(b, p).distance);
    for (const Vector3d& p : surfaceSamples(b, n)) least = std::min(least, sampleDistance(a, p).distance);
    const Separation separation = findSeparation(a, b);
    if (least > 0.0) {
      EXPECT_LE(separation.distance, least + 1e-9) << trial;
      EXPECT_GE(separation.distance, least - 0.004) << trial;
    } else {
      // Moving a out along the normal by the depth must part them, and by less must not.
      ConvexShape moved = a;
      EXPECT_LE(separation.distance, 1e-9) << trial;
      moved.X_WG.translation() += (1e-9 - separation.distance) * separation.normal;
      EXPECT_GE(findSeparation(moved, b).distance, 0.0) << trial;
      for (const Vector3d& p : surfaceSamples(moved, n)) EXPECT_GE(sampleDistance(b, p).distance, -1e-8);
      // No direction of many is a shorter way out.
      for (int i = 0; i < 3000; ++i) {
        const Vector3d direction = random.rotation() * Vector3d::UnitZ();
        EXPECT_LE(separationAlong(a, b, direction), separation.distance + 1e-7) << trial;
      }
    }
  }
}

}  // namespace
}  // namespace monolith
