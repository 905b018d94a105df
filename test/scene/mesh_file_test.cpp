// Meshes written by the test in each format, read back.

#include "scene/mesh_file.h"

#include <gtest/gtest.h>

#include <sstream>

#include "geometry/mesh.h"
#include "scene/scene.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

const int kTetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};  // anticlockwise from outside
const double kCorners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};   // volume 1

std::string obj(int triangles, bool inside_out) {
  std::ostringstream text;
  for (const auto& c : kCorners) text << "v " << c[0] << " " << c[1] << " " << c[2] << "\n";
  for (int i = 0; i < triangles; ++i) {
    const int* t = kTetrahedron[i];
    text << "f " << t[0] + 1 << " " << t[inside_out ? 2 : 1] + 1 << " " << t[inside_out ? 1 : 2] + 1 << "\n";
  }
  return text.str();
}

std::string stl() {
  std::ostringstream text;
  text << "solid tetrahedron\n";
  for (const auto& t : kTetrahedron) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : t) {
      text << "vertex " << kCorners[corner][0] << " " << kCorners[corner][1] << " " << kCorners[corner][2] << "\n";
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid tetrahedron\n";
  return text.str();
}

// Centimetres, and moved by a node by (10, 20, 30) cm.
std::string dae(const std::string& up_axis) {
  std::ostringstream text;
  text << R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>)"
       << up_axis << R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">)";
  for (const auto& c : kCorners) text << c[0] << " " << c[1] << " " << c[2] << " ";
  text << R"(</float_array><technique_common><accessor source="#pa" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>)";
  for (const auto& t : kTetrahedron) text << t[0] << " " << t[1] << " " << t[2] << " ";
  text << R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>10 20 30</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  return text.str();
}

void expectTetrahedron(const TriangleMesh& mesh, const AlignedBox3d& box) {
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_FALSE(findDefects(mesh).any());
  EXPECT_NEAR(signedVolume(mesh), box.volume() / 6.0, 1e-5 * box.volume());
  const double tolerance = 1e-5 * box.sizes().norm();
  EXPECT_LT((vertexBounds(mesh).min() - box.min()).norm(), tolerance);
  EXPECT_LT((vertexBounds(mesh).max() - box.max()).norm(), tolerance);
}

std::string errorOf(const std::string& path, const Vector3d& scale = Vector3d::Ones()) {
  try {
    loadMeshFile(path, scale);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MeshFile, ReadsObjStlAndDae) {
  const TemporaryFolder folder;
  const AlignedBox3d metres(Vector3d::Zero(), Vector3d(1, 2, 3));
  expectTetrahedron(loadMeshFile(folder.write("a.obj", obj(4, false)), Vector3d::Ones()), metres);
  expectTetrahedron(loadMeshFile(folder.write("a.stl", stl()), Vector3d::Ones()), metres);
  for (const char* up_axis : {"Z_UP", "Y_UP"}) {
    expectTetrahedron(loadMeshFile(folder.write("a.dae", dae(up_axis)), Vector3d::Ones()),
                      AlignedBox3d(Vector3d(0.1, 0.2, 0.3), Vector3d(0.11, 0.22, 0.33)));
  }
}

TEST(MeshFile, AppliesTheScaleAndKeepsAMirroredMeshOutward) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.obj", obj(4, false));
  expectTetrahedron(loadMeshFile(file, Vector3d(0.1, 0.2, 1.0)), AlignedBox3d(Vector3d::Zero(), Vector3d(0.1, 0.4, 3)));
  expectTetrahedron(loadMeshFile(file, Vector3d(-1, 1, 1)), AlignedBox3d(Vector3d(-1, 0, 0), Vector3d(0, 2, 3)));
}

TEST(MeshFile, TurnsAnInsideOutMeshOver) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = loadMeshFile(folder.write("a.obj", obj(4, true)), Vector3d::Ones());
  EXPECT_NEAR(signedVolume(mesh), 1.0, 1e-6);
}

TEST(MeshFile, RefusesAnOpenMeshWithTheNumberOfOpenEdges) {
  const TemporaryFolder folder;
  const std::string file = folder.write("open.obj", obj(3, false));
  const std::string error = errorOf(file);
  EXPECT_NE(error.find(file), std::string::npos) << error;
  EXPECT_NE(error.find("3 open edge"), std::string::npos) << error;
}

TEST(MeshFile, RefusesWhatIsNoMesh) {
  const TemporaryFolder folder;
  EXPECT_NE(errorOf(folder.write("a.stl", "not a mesh")).find("a.stl"), std::string::npos);
  EXPECT_NE(errorOf(folder.write("a.obj", "")).find("a.obj"), std::string::npos);
  EXPECT_NE(errorOf(folder.path() + "/none.obj").find("none.obj"), std::string::npos);
  EXPECT_NE(errorOf(folder.write("flat.obj", obj(4, false)), Vector3d(1, 1, 1e-13)).find("flat.obj"),
            std::string::npos);
}

TEST(MeshFile, RefusesAScaleByMistake) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.obj", obj(4, false));  // 3.7 m across
  for (const double scale : {1e-100, 1e-7, 1e6, 1e150, 1e300}) {
    const std::string error = errorOf(file, Vector3d::Constant(scale));
    for (const std::string& mention : {file, std::string(" m across, by its scale: expected 1e-06 to 1e+06 m")}) {
      EXPECT_NE(error.find(mention), std::string::npos) << scale << ": " << error;
    }
  }
  // One axis of it is enough.
  EXPECT_NE(errorOf(file, Vector3d(1, 1, 1e300)).find("m across"), std::string::npos);
  for (const double scale : {1e-6, 1e5}) EXPECT_EQ(errorOf(file, Vector3d::Constant(scale)), "no error") << scale;
}

}  // namespace
}  // namespace monolith
