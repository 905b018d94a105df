#include <gtest/gtest.h>

#include <cmath>

#include "rigid/convex_shape.h"
#include "rigid/mesh_surface.h"
#include "rigid_bodies.h"

namespace monolith {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::boxMesh;
using test::boxShape;
using test::cornerMesh;
using test::cylinderShape;
using test::detectPair;
using test::pose;
using test::sphereShape;
using test::turn;

TEST(MeshSurface, ABoxMeshHasTheDistanceOfTheBox) {
  const Vector3d size(0.6, 1.0, 0.3);
  const MeshSurface surface(*boxMesh(size).mesh);
  const ConvexShape box = placeConvex(boxShape(size), Eigen::Isometry3d::Identity());
  EXPECT_EQ(surface.convexEdges().size(), 12u);  // without the diagonals
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = random.inCube(0.8);
    const DistanceSample mesh = surface.sample(p), exact = sampleDistance(box, p);
    EXPECT_NEAR(mesh.distance, exact.distance, 1e-14);
    const Vector3d step = 1e-6 * mesh.gradient;
    EXPECT_NEAR(sampleDistance(box, p + step).distance - exact.distance, 1e-6, 1e-9);
  }
}

TEST(MeshSurface, SignsAreRightBesideAConcaveEdge) {
  const MeshSurface surface(*cornerMesh().mesh);
  test::Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = Vector3d(1, 0.5, 1) + random.inCube(1.4);
    const bool inside =
        p.y() > 0 && p.y() < 1 && p.x() > 0 && p.z() > 0 && ((p.x() < 2 && p.z() < 1) || (p.x() < 1 && p.z() < 2));
    EXPECT_EQ(surface.sample(p).distance < 0.0, inside);
  }
  EXPECT_EQ(surface.convexEdges().size(), 17u);  // 18 edges of the prism, one of them concave
}

// Two plates of 1 x 1 x 0.2 m; the upper a mesh (1), the lower (2) or both (3).
class FlatMesh : public ::testing::TestWithParam<std::tuple<int, double, double>> {};

TEST_P(FlatMesh, GivesTheWholeSupportPolygon) {
  const auto [kinds, degrees, gap] = GetParam();
  const Vector3d size(1, 1, 0.2);
  const Shape upper = kinds & 1 ? boxMesh(size) : boxShape(size), lower = kinds & 2 ? boxMesh(size) : boxShape(size);
  for (const double shift : {0.0, 1e-9, -1e-7, 0.6}) {
    const auto contacts = detectPair(upper, pose(Vector3d(shift, 0, 0.2 + gap), turn(degrees, Vector3d::UnitZ())),
                                     lower, pose(Vector3d::Zero()), 0.02);
    EXPECT_GE(contacts.size(), 4u);
    EXPECT_LE(contacts.size(), 16u);
    EXPECT_TRUE(test::supports(contacts, Vector3d(0.5 * shift, 0, 0)));
    if (shift == 0.6) {
      EXPECT_FALSE(test::supports(contacts, Vector3d(0.6, 0, 0)));
    }
    for (const Contact& contact : contacts) {
      EXPECT_LT((contact.normal - Vector3d::UnitZ()).norm(), 1e-9) << "shift " << shift;
      EXPECT_NEAR(contact.gap, gap, 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(KindsAnglesAndGaps, FlatMesh,
                         ::testing::Combine(::testing::Values(1, 2, 3), ::testing::Values(0.0, 30.0, 45.0),
                                            ::testing::Values(-0.005, -1e-7, 0.0, 1e-7, 0.01)));

TEST(MeshContacts, EdgeAcrossEdge) {
  const Vector3d size(2, 0.2, 0.2);
  const double diagonal = 0.1 * std::sqrt(2.0);
  const Quaterniond roll = turn(45.0, Vector3d::UnitX());
  for (const bool both : {false, true})
    for (const double gap : {-0.02, -1e-8, 0.0, 0.01}) {
      const auto contacts =
          detectPair(both ? boxMesh(size) : boxShape(size), pose(Vector3d(0.1, 0, 2 * diagonal + gap), roll),
                     boxMesh(size), pose(Vector3d(0, 0.1, 0), turn(90.0, Vector3d::UnitZ()) * roll), 0.02);
      ASSERT_EQ(contacts.size(), 1u) << both << " " << gap;
      EXPECT_NEAR(contacts[0].gap, gap, 1e-9);
      EXPECT_LT((contacts[0].normal - Vector3d::UnitZ()).norm(), 1e-9);
    }
}

TEST(MeshContacts, CylinderStandsAndLies) {
  const Shape floor = boxMesh(Vector3d(3, 3, 1));
  const Shape cylinder = cylinderShape(0.3, 1.0);
  for (const double gap : {-0.004, 0.0, 0.004}) {
    const auto stands = detectPair(cylinder, pose(Vector3d(0.2, 0.1, 1 + gap)), floor, pose(Vector3d::Zero()), 0.01);
    EXPECT_GE(stands.size(), 8u);
    EXPECT_TRUE(test::supports(stands, Vector3d(0.4, 0.1, 0)));
    const Quaterniond on_side = turn(20, Vector3d::UnitZ()) * turn(90.0, Vector3d::UnitX());
    const auto lies =
        detectPair(cylinder, pose(Vector3d(0.2, 0.1, 0.8 + gap), on_side), floor, pose(Vector3d::Zero()), 0.01);
    EXPECT_EQ(lies.size(), 2u);
    for (const auto& contacts : {stands, lies})
      for (const Contact& contact : contacts) {
        EXPECT_NEAR(contact.gap, gap, 1e-9);
        EXPECT_LT((contact.normal - Vector3d::UnitZ()).norm(), 1e-9);
      }
  }
}

TEST(MeshContacts, MeshEdgeOnTheSideOfACylinder) {
  const Quaterniond roll = turn(45.0, Vector3d::UnitX());
  const auto contacts =
      detectPair(boxMesh(Vector3d(2, 0.2, 0.2)), pose(Vector3d(0.1, 0, 0.3 + 0.1 * std::sqrt(2.0) + 0.002), roll),
                 cylinderShape(0.3, 1.0), pose(Vector3d::Zero(), turn(90.0, Vector3d::UnitX())), 0.01);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].gap, 0.002, 1e-9);
  EXPECT_LT((contacts[0].normal - Vector3d::UnitZ()).norm(), 1e-7);
}

TEST(MeshContacts, SphereInAGrooveTouchesBothSides) {
  const auto contacts =
      detectPair(sphereShape(0.25), pose(Vector3d(1.252, 0.5, 1.251)), cornerMesh(), pose(Vector3d::Zero()), 0.01);
  ASSERT_EQ(contacts.size(), 2u);
  for (const Contact& contact : contacts) {
    const bool side = contact.normal.x() > 0.5;
    EXPECT_LT((contact.normal - (side ? Vector3d::UnitX() : Vector3d::UnitZ())).norm(), 1e-9);
    EXPECT_NEAR(contact.gap, side ? 0.002 : 0.001, 1e-9);
  }
  EXPECT_EQ(
      detectPair(sphereShape(0.25), pose(Vector3d(1.7, 0.5, 1.24)), cornerMesh(), pose(Vector3d::Zero()), 0.01).size(),
      1u);
}

// A finely divided ball: more vertices in reach than contacts allowed.
Shape ballMesh(double radius, int rings) {
  std::vector<Vector3d> vertices{Vector3d(0, 0, radius)};
  const int n = 2 * rings;
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < n; ++j) {
      const double theta = M_PI * i / rings, phi = 2 * M_PI * j / n;
      vertices.push_back(radius *
                         Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  vertices.emplace_back(0, 0, -radius);
  std::vector<Eigen::Vector3i> triangles;
  const int last = static_cast<int>(vertices.size()) - 1;
  for (int j = 0; j < n; ++j) {
    const int k = (j + 1) % n;
    triangles.emplace_back(0, 1 + j, 1 + k);
    triangles.emplace_back(last, last - n + k, last - n + j);
    for (int i = 0; i + 2 < rings; ++i) {
      const int a = 1 + i * n, b = a + n;
      triangles.emplace_back(a + j, b + j, b + k);
      triangles.emplace_back(a + j, b + k, a + k);
    }
  }
  return test::meshShape(vertices, triangles);
}

TEST(MeshContacts, ManyVerticesAreReducedAroundTheDeepest) {
  const Shape ball = ballMesh(0.5, 30);
  const auto contacts =
      detectPair(ball, pose(Vector3d(0, 0, 0.995)), boxShape(Vector3d(2, 2, 1)), pose(Vector3d::Zero()), 0.03);
  EXPECT_GE(contacts.size(), 8u);
  EXPECT_LE(contacts.size(), 16u);
  EXPECT_NEAR(test::leastGap(contacts), -0.005, 1e-9);
  EXPECT_TRUE(test::supports(contacts, Vector3d::Zero()));
  for (const Contact& contact : contacts) EXPECT_LT((contact.normal - Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(MeshContacts, AgreesWithDenseSamplingWhenApart) {
  const Shape shapes[] = {boxMesh(Vector3d(0.5, 0.3, 0.4)), boxShape(Vector3d(0.4, 0.4, 0.2)), cylinderShape(0.2, 0.5),
                          cornerMesh()};
  test::Random random(11);
  int tested = 0;
  for (int trial = 0; trial < 800; ++trial) {
    const Shape &mesh = shapes[trial % 2 ? 0 : 3], &other = shapes[trial % 4];
    const Eigen::Isometry3d X_A = pose(random.inCube(0.2), random.rotation()),
                            X_B = pose(random.inCube(1.5), random.rotation());
    const MeshSurface surface(*mesh.mesh);
    std::vector<Vector3d> points;  // of the other's surface, in the frame of the mesh
    if (other.kind == Shape::Kind::kMesh) {
      for (const Eigen::Vector3i& t : other.mesh->triangles)
        for (int i = 0; i <= 30; ++i)
          for (int j = 0; i + j <= 30; ++j)
            points.push_back(other.mesh->vertices[t[0]] +
                             (other.mesh->vertices[t[1]] - other.mesh->vertices[t[0]]) * (i / 30.0) +
                             (other.mesh->vertices[t[2]] - other.mesh->vertices[t[0]]) * (j / 30.0));
    } else {
      const ConvexShape convex = placeConvex(other, Eigen::Isometry3d::Identity());
      for (int i = 0; i < 4000; ++i) {
        const Vector3d p = random.inCube(0.4);
        const DistanceSample sample = sampleDistance(convex, p);
        points.push_back(p - sample.distance * sample.gradient);
      }
    }
    double least = 1e300;
    for (const Vector3d& p : points) least = std::min(least, surface.sample(X_A.inverse() * (X_B * p)).distance);
    // The one wholly inside the other is not apart.
    bool inside = false;
    if (other.kind == Shape::Kind::kMesh) {
      const MeshSurface other_surface(*other.mesh);
      for (const Vector3d& p : mesh.mesh->vertices) {
        inside = inside || other_surface.sample(X_B.inverse() * (X_A * p)).distance < 0.0;
      }
    } else {
      for (const Vector3d& p : mesh.mesh->vertices) {
        inside = inside || sampleDistance(placeConvex(other, X_B), X_A * p).distance < 0.0;
      }
    }
    if (inside) continue;
    const double margin = 0.1;
    const auto contacts = detectPair(mesh, X_A, other, X_B, margin);
    if (least > margin + 0.05) {
      EXPECT_TRUE(contacts.empty()) << trial;
    } else if (least > 0.03 && least < margin - 0.02) {
      ++tested;
      ASSERT_FALSE(contacts.empty()) << trial;
      EXPECT_LE(test::leastGap(contacts), least + 0.1 * margin) << trial;
      EXPECT_GE(test::leastGap(contacts), least - 0.03 - 0.1 * margin) << trial;
    }
  }
  EXPECT_GT(tested, 10);
}

}  // namespace
}  // namespace monolith
