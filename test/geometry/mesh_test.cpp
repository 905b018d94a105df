// What makes a triangle surface a solid, and its volume.

#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include "mesh_samples.h"

namespace monolith {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

TEST(Mesh, CuboidIsClosedAndHasItsVolume) {
  const TriangleMesh mesh = cuboid(Vector3d(2.0, 3.0, 4.0), Vector3d(100.0, -50.0, 7.0));
  EXPECT_FALSE(findDefects(mesh).any());
  EXPECT_NEAR(signedVolume(mesh), 24.0, 1e-12);
}

TEST(Mesh, FlipChangesTheSignOfTheVolumeOnly) {
  TriangleMesh mesh = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  flipOrientation(mesh);
  EXPECT_FALSE(findDefects(mesh).any());
  EXPECT_NEAR(signedVolume(mesh), -1.0, 1e-14);
}

TEST(Mesh, MissingTriangleLeavesThreeOpenEdges) {
  TriangleMesh mesh = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  mesh.triangles.pop_back();
  EXPECT_EQ(findDefects(mesh).open_edges, 3);
}

TEST(Mesh, DoubledTriangleIsNotManifold) {
  TriangleMesh mesh = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  mesh.triangles.push_back(mesh.triangles.front());
  EXPECT_EQ(findDefects(mesh).open_edges, 3);
}

TEST(Mesh, TurnedTriangleIsMisoriented) {
  TriangleMesh mesh = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  std::swap(mesh.triangles.front()[0], mesh.triangles.front()[1]);
  EXPECT_EQ(findDefects(mesh).open_edges, 0);
  EXPECT_EQ(findDefects(mesh).misoriented_edges, 3);
}

TEST(Mesh, CavityIsAnInwardPart) {
  TriangleMesh mesh = cuboid(Vector3d(3.0, 3.0, 3.0), Vector3d::Zero());
  TriangleMesh cavity = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  append(cavity, mesh);
  EXPECT_FALSE(findDefects(mesh).any());
  flipOrientation(cavity);
  TriangleMesh hollow = cuboid(Vector3d(3.0, 3.0, 3.0), Vector3d::Zero());
  append(cavity, hollow);
  EXPECT_EQ(findDefects(hollow).inward_parts, 1);
}

TEST(Mesh, WeldingClosesATriangleSoup) {
  const TriangleMesh mesh = cuboid(Vector3d(1.0, 2.0, 3.0), Vector3d(0.3, 0.1, 0.7));
  TriangleMesh soup;
  double jitter = 0.0;
  for (const Vector3i& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      soup.vertices.push_back(mesh.vertices[corner] + Vector3d(jitter, -jitter, jitter));
      jitter = 1e-8 - jitter;
    }
    const int last = static_cast<int>(soup.vertices.size()) - 1;
    soup.triangles.emplace_back(last - 2, last - 1, last);
  }
  soup.vertices.push_back(Vector3d(50.0, 0.0, 0.0));  // of no triangle
  EXPECT_EQ(findDefects(soup).open_edges, 36);
  const TriangleMesh welded = weldVertices(soup, 1e-6);
  EXPECT_EQ(welded.vertices.size(), 8u);
  EXPECT_FALSE(findDefects(welded).any());
  EXPECT_NEAR(signedVolume(welded), 6.0, 1e-6);
}

TEST(Mesh, WeldingDropsCollapsedTriangles) {
  TriangleMesh mesh = cuboid(Vector3d(1.0, 1.0, 1.0), Vector3d::Zero());
  mesh.triangles.emplace_back(0, 0, 1);
  EXPECT_EQ(weldVertices(mesh, 1e-9).triangles.size(), 12u);
}

}  // namespace
}  // namespace monolith
