#include "scene/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <sstream>

#include "geometry/mesh.h"
#include "scene/scene.h"

namespace monolith {
namespace {

// Of the mesh's diagonal. STL and OBJ files hold float coordinates, some of them printed with six digits.
constexpr double kWeldTolerance = 2e-6;
// m, of a mesh's diagonal: beyond, somebody has mistaken the scale.
constexpr double kLeastAcross = 1e-6, kMostAcross = 1e6;

void appendNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, TriangleMesh& mesh) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const int first = static_cast<int>(mesh.vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D vertex = transform * part.mVertices[i];
      mesh.vertices.emplace_back(vertex.x, vertex.y, vertex.z);
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      mesh.triangles.emplace_back(first + static_cast<int>(face.mIndices[0]),
                                  first + static_cast<int>(face.mIndices[1]),
                                  first + static_cast<int>(face.mIndices[2]));
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) appendNode(scene, *node.mChildren[i], transform, mesh);
}

TriangleMesh importTriangles(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    throw SceneError(path + ": " + importer.GetErrorString() + ": expected a readable STL, OBJ or DAE mesh");
  }
  TriangleMesh mesh;
  mesh.source = path;
  appendNode(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  return mesh;
}

void requireSolid(const TriangleMesh& mesh) {
  const MeshDefects defects = findDefects(mesh);
  std::string text;
  const auto mention = [&](int count, const std::string& what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  mention(defects.open_edges, "open edge(s) (not shared by exactly two triangles)");
  mention(defects.misoriented_edges, "edge(s) between triangles of opposite winding");
  mention(defects.inward_parts, "part(s) wound inwards or hollowing out another");
  if (!text.empty()) {
    throw SceneError(mesh.source + ": not a closed surface: " + text + " of " +
                     std::to_string(mesh.triangles.size()) + " triangles: expected a watertight mesh");
  }
}

}  // namespace

TriangleMesh loadMeshFile(const std::string& path, const Eigen::Vector3d& scale) {
  TriangleMesh mesh = importTriangles(path);
  for (Eigen::Vector3d& vertex : mesh.vertices) {
    vertex = vertex.cwiseProduct(scale);
    if (!vertex.allFinite()) throw SceneError(path + ": a vertex is not finite: expected finite coordinates");
  }
  if (mesh.triangles.empty()) throw SceneError(path + ": no triangles: expected a triangle mesh");
  const double across = vertexBounds(mesh).diagonal().norm();
  if (!(across >= kLeastAcross && across <= kMostAcross)) {
    std::ostringstream text;
    text << path << ": " << across << " m across, by its scale: expected " << kLeastAcross << " to " << kMostAcross
         << " m";
    throw SceneError(text.str());
  }
  mesh = weldVertices(mesh, kWeldTolerance * vertexBounds(mesh).diagonal().norm());
  requireSolid(mesh);
  double enclosed = signedVolume(mesh);
  if (enclosed < 0.0) {
    flipOrientation(mesh);
    enclosed = -enclosed;
  }
  // Also catches the mesh that welding has emptied.
  if (mesh.triangles.empty() || !(enclosed > 1e-9 * std::pow(vertexBounds(mesh).diagonal().norm(), 3))) {
    throw SceneError(path + ": encloses " + std::to_string(enclosed) + " m^3: expected a solid with a volume");
  }
  return mesh;
}

}  // namespace monolith
