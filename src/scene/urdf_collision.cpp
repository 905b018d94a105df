#include "scene/urdf_collision.h"

#include <cmath>
#include <memory>

#include "scene/mesh_file.h"
#include "scene/resource_path.h"
#include "scene/shown_vector.h"
#include "scene/urdf_pose.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

bool positive(const Vector3d& v) { return v.allFinite() && (v.array() > 0.0).all(); }

double requirePositive(const std::string& what, double value, UrdfErrors& errors) {
  if (!std::isfinite(value) || !(value > 0.0)) {
    errors.add(what + " " + std::to_string(value), "expected a length > 0");
  }
  return value;
}

std::shared_ptr<const TriangleMesh> loadMesh(const urdf::Mesh& mesh, const std::string& name, const UrdfText& urdf,
                                             const SceneResolver& resolver, UrdfErrors& errors) {
  const Vector3d scale = toEigen(mesh.scale);
  if (!scale.allFinite() || (scale.array() == 0.0).any()) {
    errors.add(name + ": mesh scale " + shownVector(scale), "expected three factors other than 0");
    return nullptr;
  }
  try {
    const std::string path = resolveResource(mesh.filename, urdf.folder, resolver);
    return std::make_shared<const TriangleMesh>(loadMeshFile(path, scale));
  } catch (const SceneError& error) {
    errors.addLine(urdf.source + ": " + name + ": mesh " + error.what());
    return nullptr;
  }
}

}  // namespace

std::optional<Shape> readUrdfCollision(const urdf::Collision& collision, const std::string& name,
                                       const Eigen::Isometry3d& X_BL, const UrdfText& urdf,
                                       const SceneResolver& resolver, UrdfErrors& errors) {
  Shape shape;
  shape.name = name;
  shape.X_BG = X_BL * toEigen(collision.origin);
  if (!shape.X_BG.matrix().allFinite()) errors.add(name + ": origin", "expected finite coordinates");
  if (!collision.geometry) {
    errors.add(name + ": no geometry", "expected a box, sphere, cylinder or mesh");
    return std::nullopt;
  }
  if (const auto* box = dynamic_cast<const urdf::Box*>(collision.geometry.get())) {
    shape.kind = Shape::Kind::kBox;
    shape.box_size = toEigen(box->dim);
    if (!positive(shape.box_size)) {
      errors.add(name + ": box size " + shownVector(shape.box_size), "expected three lengths > 0");
    }
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision.geometry.get())) {
    shape.kind = Shape::Kind::kSphere;
    shape.radius = requirePositive(name + ": sphere radius", sphere->radius, errors);
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision.geometry.get())) {
    shape.kind = Shape::Kind::kCylinder;
    shape.radius = requirePositive(name + ": cylinder radius", cylinder->radius, errors);
    shape.length = requirePositive(name + ": cylinder length", cylinder->length, errors);
  } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get())) {
    shape.kind = Shape::Kind::kMesh;
    shape.mesh = loadMesh(*mesh, name, urdf, resolver, errors);
    if (!shape.mesh) return std::nullopt;
  }
  return shape;
}

}  // namespace monolith
