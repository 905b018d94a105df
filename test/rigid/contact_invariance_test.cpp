// Contacts must not depend on who is called a, on where the world's origin is, on which of its periodic images a body
// is given by, or on what was detected before.
#include <gtest/gtest.h>

#include <algorithm>

#include "rigid/convex_shape.h"
#include "rigid/mesh_surface.h"
#include "rigid_bodies.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::pose;

std::vector<Shape> allShapes() {
  return {test::boxShape(Vector3d(0.5, 0.3, 0.4)), test::sphereShape(0.25), test::cylinderShape(0.2, 0.5),
          test::boxMesh(Vector3d(0.4, 0.5, 0.3))};
}

// Every contact of `a` has its like in `b`.
void expectSame(const std::vector<Contact>& a, const std::vector<Contact>& b, double tolerance) {
  EXPECT_EQ(a.size(), b.size());
  for (const Contact& contact : a) {
    const bool found = std::any_of(b.begin(), b.end(), [&](const Contact& other) {
      return (contact.point - other.point).norm() < tolerance && (contact.normal - other.normal).norm() < tolerance &&
             std::abs(contact.gap - other.gap) < tolerance;
    });
    EXPECT_TRUE(found) << contact.point.transpose() << " normal " << contact.normal.transpose() << " gap "
                       << contact.gap;
  }
}

template <typename Function>
void forRandomPairs(unsigned seed, const Function& function) {
  test::Random random(seed);
  const std::vector<Shape> shapes = allShapes();
  for (const Shape& a : shapes)
    for (const Shape& b : shapes)
      for (int trial = 0; trial < 40; ++trial) {
        function(random, a, pose(random.inCube(0.5), random.rotation()), b,
                 pose(random.inCube(0.1), random.rotation()));
      }
}

// Overlaps of cylinders that are deep have several ways out that are about as short: which is found may differ.
bool isAmbiguous(const Shape& a, const Shape& b, const std::vector<Contact>& contacts) {
  const bool cylinder = a.kind == Shape::Kind::kCylinder || b.kind == Shape::Kind::kCylinder;
  return cylinder && test::leastGap(contacts) < -0.03;
}

double sd(const Shape& shape, const Isometry3d& X, const Vector3d& p) {
  if (shape.kind == Shape::Kind::kMesh) return MeshSurface(*shape.mesh).sample(X.inverse() * p).distance;
  return sampleDistance(placeConvex(shape, X), p).distance;
}

TEST(ContactInvariance, ExchangeOfBodies) {
  forRandomPairs(21, [](test::Random&, const Shape& a, const Isometry3d& X_A, const Shape& b, const Isometry3d& X_B) {
    auto swapped = test::detectPair(b, X_B, a, X_A, 0.02);
    if (isAmbiguous(a, b, swapped)) return;
    for (Contact& contact : swapped) contact.normal = -contact.normal;
    const double tolerance = a.kind == Shape::Kind::kCylinder || b.kind == Shape::Kind::kCylinder ? 1e-6 : 1e-8;
    expectSame(test::detectPair(a, X_A, b, X_B, 0.02), swapped, tolerance);
  });
}

TEST(ContactInvariance, CommonRigidMotion) {
  forRandomPairs(
      22, [](test::Random& random, const Shape& a, const Isometry3d& X_A, const Shape& b, const Isometry3d& X_B) {
        const Isometry3d X = pose(random.inCube(2.0), random.rotation());
        auto moved = test::detectPair(a, X * X_A, b, X * X_B, 0.02);
        if (isAmbiguous(a, b, moved)) return;
        for (Contact& contact : moved) {
          contact.point = X.inverse() * contact.point;
          contact.normal = X.linear().transpose() * contact.normal;
        }
        const double tolerance = a.kind == Shape::Kind::kCylinder || b.kind == Shape::Kind::kCylinder ? 1e-6 : 1e-8;
        expectSame(test::detectPair(a, X_A, b, X_B, 0.02), moved, tolerance);
      });
}

// Wherever the boundary cuts them: each body with its own lever arms.
TEST(ContactInvariance, PeriodicImages) {
  TankWalls walls;
  walls.inside = Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d(3.0, 4.0, 5.0));
  for (bool& periodic : walls.periodic) periodic = true;
  int across = 0;
  const auto atImages = [&](const Isometry3d& X, const Vector3d& shift) {
    Isometry3d image = X;
    image.translation() = walls.imageInside(X.translation() + shift);
    return image;
  };
  forRandomPairs(
      26, [&](test::Random& random, const Shape& a, const Isometry3d& X_A, const Shape& b, const Isometry3d& X_B) {
        const std::vector<Contact> plain = test::detectPair(a, X_A, b, X_B, 0.02);
        if (isAmbiguous(a, b, plain)) return;
        const Vector3d shift = random.inCube(10.0);
        const Isometry3d image_A = atImages(X_A, shift), image_B = atImages(X_B, shift);
        const std::vector<RigidBody> bodies{test::makeBody("a", {a}, image_A), test::makeBody("b", {b}, image_B)};
        std::vector<Contact> periodic = test::detect(bodies, 0.02, walls);
        for (Contact& contact : periodic) {
          across += contact.shift_b.isZero() ? 0 : 1;
          const Vector3d at_b = contact.pointOnB() - image_B.translation() + X_B.translation();
          contact.point += X_A.translation() - image_A.translation();
          EXPECT_LT((contact.point - at_b).norm(), 1e-12);
        }
        const double tolerance = a.kind == Shape::Kind::kCylinder || b.kind == Shape::Kind::kCylinder ? 1e-6 : 1e-8;
        expectSame(plain, periodic, tolerance);
      });
  EXPECT_GT(across, 50);
}

// Two bodies that touch on both sides of the tank do so there as well.
TEST(ContactDetector, FindsAPairInSeveralImages) {
  TankWalls walls;
  walls.inside = Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d::Ones());
  walls.periodic[0] = true;
  const auto at = [](double x) { return pose(Vector3d(x, 0.5, 0.5)); };
  std::vector<RigidBody> bodies{test::makeBody("a", {test::boxShape(Vector3d(0.5, 0.2, 0.2))}, at(0.25)),
                                test::makeBody("b", {test::boxShape(Vector3d(0.5, 0.2, 0.2))}, at(0.75))};
  std::vector<Contact> contacts = test::detect(bodies, 0.01, walls);
  ASSERT_EQ(contacts.size(), 8u);
  const auto isAcross = [](const Contact& contact) { return contact.shift_b == Vector3d(-1.0, 0.0, 0.0); };
  EXPECT_EQ(std::count_if(contacts.begin(), contacts.end(), isAcross), 4);
  for (const Contact& contact : contacts) {
    EXPECT_NEAR(contact.gap, 0.0, 1e-12);
    EXPECT_NEAR(contact.normal[0], isAcross(contact) ? 1.0 : -1.0, 1e-12);
    EXPECT_NEAR(contact.point[0], isAcross(contact) ? 0.0 : 0.5, 1e-12);
  }
  // What is not free gives none; nor does a body with itself.
  for (RigidBody& body : bodies) body.motion = BodyMotion::kFixed;
  EXPECT_TRUE(test::detect(bodies, 0.01, walls).empty());
  bodies = {test::makeBody("a", {test::boxShape(Vector3d(1.0, 0.2, 0.2))}, at(0.5))};
  EXPECT_TRUE(test::detect(bodies, 0.01, walls).empty());
  // On a plate of several periods there is no contact twice.
  bodies = {test::makeBody("plate", {test::boxShape(Vector3d(3.0, 1.0, 0.2))}, at(0.5), BodyMotion::kFixed),
            test::makeBody("cube", {test::boxShape(Vector3d::Constant(0.2))}, pose(Vector3d(0.4, 0.5, 0.7)))};
  EXPECT_EQ(test::detect(bodies, 0.01, walls).size(), 4u);
}

// The point lies half-way between the surfaces: gap/2 from each, measured along the normal.
TEST(ContactInvariance, PointsLieBetweenTheSurfaces) {
  forRandomPairs(23, [](test::Random&, const Shape& a, const Isometry3d& X_A, const Shape& b, const Isometry3d& X_B) {
    for (const Contact& contact : test::detectPair(a, X_A, b, X_B, 0.02)) {
      EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-12);
      EXPECT_LE(contact.gap, 0.02);
      const double limit = 0.5 * std::abs(contact.gap) + 0.003;
      if (contact.gap > -0.02) {
        EXPECT_LT(std::abs(sd(a, X_A, contact.point)), limit);
        EXPECT_LT(std::abs(sd(b, X_B, contact.point)), limit);
      }
    }
  });
}

TEST(ContactInvariance, NothingBeyondTheMargin) {
  const std::vector<Shape> shapes = allShapes();
  test::Random random(24);
  for (const Shape& a : shapes)
    for (const Shape& b : shapes) {
      const Eigen::Quaterniond q_a = random.rotation(), q_b = random.rotation();
      // Apart by their bounding boxes.
      const double reach =
          bounds(a, pose(Vector3d::Zero(), q_a)).max().x() - bounds(b, pose(Vector3d::Zero(), q_b)).min().x();
      EXPECT_TRUE(
          test::detectPair(a, pose(Vector3d::Zero(), q_a), b, pose(Vector3d(reach + 0.0201, 0, 0), q_b), 0.02).empty());
    }
}

TEST(ContactInvariance, HistoryDoesNotMatter) {
  test::Random random(25);
  std::vector<Shape> shapes = allShapes();
  std::vector<RigidBody> bodies;
  for (int i = 0; i < 24; ++i) {
    bodies.push_back(
        test::makeBody("body", {shapes[i % 4], shapes[(i + 1) % 4]}, pose(random.inCube(0.8), random.rotation())));
    bodies.back().shapes[1].X_BG.translation() = Vector3d(0.2, 0, 0);
  }
  TankWalls walls;
  walls.inside = Eigen::AlignedBox3d(Vector3d::Constant(-1), Vector3d::Constant(1));
  ContactDetector wandering(bodies, walls);
  std::vector<RigidBody> moved = bodies;
  for (int step = 0; step < 5; ++step) {
    for (RigidBody& body : moved) body.p_WBcm += random.inCube(0.3);
    wandering.detect(moved, 0.01 * step);
  }
  const std::vector<Contact> first = ContactDetector(bodies, walls).detect(bodies, 0.02);
  const std::vector<Contact> later = wandering.detect(bodies, 0.02);
  ASSERT_GT(first.size(), 50u);
  ASSERT_EQ(first.size(), later.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].body_a, later[i].body_a);
    EXPECT_EQ(first[i].body_b, later[i].body_b);
    EXPECT_EQ(first[i].point, later[i].point);
    EXPECT_EQ(first[i].normal, later[i].normal);
    EXPECT_EQ(first[i].gap, later[i].gap);
  }
}

TEST(ContactDetector, RefusesAnotherNumberOfBodies) {
  const std::vector<RigidBody> bodies{test::makeBody("a", {test::sphereShape(1)}, pose(Vector3d::Zero()))};
  ContactDetector detector(bodies, test::farWalls());
  EXPECT_THROW(detector.detect({}, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace monolith
