#include "scene/urdf_body.h"

#include <tinyxml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "scene/mass_properties.h"
#include "scene/mesh_file.h"
#include "scene/resource_path.h"
#include "scene/shown_vector.h"
#include "scene/urdf_parser.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kDeepest = 1000;  // joints from the root to a link: trees are gone through recursively

Vector3d toEigen(const urdf::Vector3& v) { return Vector3d(v.x, v.y, v.z); }

Isometry3d toEigen(const urdf::Pose& pose) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)
                   .normalized()
                   .toRotationMatrix();
  X.translation() = toEigen(pose.position);
  return X;
}

const char* jointTypeName(int type) {
  switch (type) {
    case urdf::Joint::REVOLUTE: return "revolute";
    case urdf::Joint::CONTINUOUS: return "continuous";
    case urdf::Joint::PRISMATIC: return "prismatic";
    case urdf::Joint::FLOATING: return "floating";
    case urdf::Joint::PLANAR: return "planar";
    case urdf::Joint::FIXED: return "fixed";
    default: return "unknown";
  }
}

// Gathers one body from the tree of links.
class BodyReader {
 public:
  BodyReader(const UrdfText& urdf, const SceneResolver& resolver, BodyDescription& body)
      : urdf_(urdf), resolver_(resolver), body_(body) {}

  std::vector<std::string> read() {
    body_.source = urdf_.source;
    body_.shapes.clear();
    body_.links.clear();
    try {
      const urdf::ModelInterfaceSharedPtr model = parseUrdf(urdf_.xml, urdf_.source);
      visit(*model->getRoot(), Isometry3d::Identity(), 0);
      requireOneTree(*model);
      finish(model->getName());
    } catch (const SceneError& error) {
      errors_.push_back(error.what());
    }
    body_.urdf_xml = withAbsoluteMeshes();
    return errors_;
  }

 private:
  void visit(const urdf::Link& link, const Isometry3d& X_BL, int depth) {
    if (!visited_.insert(link.name).second) {
      return fail("link \"" + link.name + "\" is the child of two joints, or of one that hangs on itself",
                  "expected one tree of links");
    }
    if (depth > kDeepest) {
      return fail("link \"" + link.name + "\" is more than " + std::to_string(kDeepest) + " joints from the root",
                  "expected a shorter chain");
    }
    body_.links.push_back({link.name, X_BL});
    if (link.inertial) addInertial(link, X_BL);
    for (std::size_t i = 0; i < link.collision_array.size(); ++i) {
      const std::string name = link.name + "/collision[" + std::to_string(i) + "]";
      if (link.collision_array[i]) addCollision(*link.collision_array[i], name, X_BL);
    }
    for (const urdf::VisualSharedPtr& visual : link.visual_array) {
      if (visual) noteMesh(visual->geometry);
    }
    for (const urdf::JointSharedPtr& joint : link.child_joints) {
      if (joint->type != urdf::Joint::FIXED) {
        fail("joint \"" + joint->name + "\" (" + jointTypeName(joint->type) + ")",
             "movable joints are not supported; use type fixed");
      }
    }
    for (const urdf::LinkSharedPtr& child : link.child_links) {
      visit(*child, X_BL * toEigen(child->parent_joint->parent_to_joint_origin_transform), depth + 1);
    }
  }

  void requireOneTree(const urdf::ModelInterface& model) {
    if (!errors_.empty()) return;
    for (const auto& [name, link] : model.links_) {
      if (visited_.count(name) > 0) continue;
      fail("link \"" + name + "\" does not hang on the root, \"" + model.getRoot()->name + "\"",
           "expected one tree of links");
    }
  }

  void addInertial(const urdf::Link& link, const Isometry3d& X_BL) {
    const urdf::Inertial& inertial = *link.inertial;
    MassProperties part;
    part.mass = inertial.mass;
    part.inertia << inertial.ixx, inertial.ixy, inertial.ixz,  //
        inertial.ixy, inertial.iyy, inertial.iyz,              //
        inertial.ixz, inertial.iyz, inertial.izz;
    if (!std::isfinite(part.mass) || part.mass < 0.0) {
      fail("link \"" + link.name + "\" inertial: mass " + std::to_string(part.mass) + " kg", "expected a mass >= 0");
    } else if (const std::string violation = partViolation(part); !violation.empty()) {
      errors_.push_back(urdf_.source + ": link \"" + link.name + "\" inertial: " + violation);
    }
    parts_.push_back(transformed(part, X_BL * toEigen(inertial.origin)));
  }

  void addCollision(const urdf::Collision& collision, const std::string& name, const Isometry3d& X_BL) {
    Shape shape;
    shape.name = name;
    shape.X_BG = X_BL * toEigen(collision.origin);
    if (!shape.X_BG.matrix().allFinite()) fail(name + ": origin", "expected finite coordinates");
    if (!collision.geometry) return fail(name + ": no geometry", "expected a box, sphere, cylinder or mesh");
    if (const auto* box = dynamic_cast<const urdf::Box*>(collision.geometry.get())) {
      shape.kind = Shape::Kind::kBox;
      shape.box_size = toEigen(box->dim);
      if (!positive(shape.box_size))
        fail(name + ": box size " + shownVector(shape.box_size), "expected three lengths > 0");
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision.geometry.get())) {
      shape.kind = Shape::Kind::kSphere;
      shape.radius = requirePositive(name + ": sphere radius", sphere->radius);
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision.geometry.get())) {
      shape.kind = Shape::Kind::kCylinder;
      shape.radius = requirePositive(name + ": cylinder radius", cylinder->radius);
      shape.length = requirePositive(name + ": cylinder length", cylinder->length);
    } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get())) {
      shape.kind = Shape::Kind::kMesh;
      shape.mesh = loadMesh(*mesh, name);
      noteMesh(collision.geometry);
      if (!shape.mesh) return;
    }
    body_.shapes.push_back(shape);
  }

  std::shared_ptr<const TriangleMesh> loadMesh(const urdf::Mesh& mesh, const std::string& name) {
    const Vector3d scale = toEigen(mesh.scale);
    if (!scale.allFinite() || (scale.array() == 0.0).any()) {
      fail(name + ": mesh scale " + shownVector(scale), "expected three factors other than 0");
      return nullptr;
    }
    try {
      const std::string path = resolveResource(mesh.filename, urdf_.folder, resolver_);
      return std::make_shared<const TriangleMesh>(loadMeshFile(path, scale));
    } catch (const SceneError& error) {
      errors_.push_back(urdf_.source + ": " + name + ": mesh " + error.what());
      return nullptr;
    }
  }

  void finish(const std::string& robot) {
    if (!errors_.empty()) return;
    if (body_.shapes.empty()) {
      fail("robot \"" + robot + "\" has no <collision>", "expected at least one collision shape");
    }
    const MassProperties whole = combined(parts_);
    const std::string violation = massViolation(whole);
    if (!violation.empty()) {
      errors_.push_back(urdf_.source + ": robot \"" + robot + "\" inertial" +
                        (body_.links.size() > 1 ? " (all links together): " : ": ") + violation);
    }
    body_.mass = whole.mass;
    body_.p_BBcm = whole.centre;
    body_.inertia_Bcm = whole.inertia;
  }

  void noteMesh(const urdf::GeometrySharedPtr& geometry) {
    if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(geometry.get())) mesh_files_.insert(mesh->filename);
  }

  std::string withAbsoluteMeshes() const {
    const auto relative = [](const std::string& file) { return file.find("://") == std::string::npos; };
    if (urdf_.folder.empty() || std::none_of(mesh_files_.begin(), mesh_files_.end(), relative)) return urdf_.xml;
    TiXmlDocument document;
    document.Parse(urdf_.xml.c_str());
    const auto visit = [&](auto&& self, TiXmlElement& element) -> void {
      const char* file = element.Attribute("filename");
      if (file != nullptr && element.ValueStr() == "mesh" && relative(file)) {
        const auto path = std::filesystem::absolute(std::filesystem::path(urdf_.folder) / file).lexically_normal();
        element.SetAttribute("filename", "file://" + path.string());
      }
      for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
        self(self, *child);
      }
    };
    visit(visit, *document.RootElement());
    TiXmlPrinter printer;
    document.Accept(&printer);
    return printer.Str();
  }

  static bool positive(const Vector3d& v) { return v.allFinite() && (v.array() > 0.0).all(); }

  double requirePositive(const std::string& what, double value) {
    if (!std::isfinite(value) || !(value > 0.0)) fail(what + " " + std::to_string(value), "expected a length > 0");
    return value;
  }

  void fail(const std::string& element_and_value, const std::string& expected) {
    errors_.push_back(urdf_.source + ": " + element_and_value + ": " + expected);
  }

  const UrdfText& urdf_;
  const SceneResolver& resolver_;
  BodyDescription& body_;
  std::vector<MassProperties> parts_;
  std::set<std::string> visited_;
  std::set<std::string> mesh_files_;
  std::vector<std::string> errors_;
};

}  // namespace

std::vector<std::string> readUrdfBody(const UrdfText& urdf, const SceneResolver& resolver, BodyDescription& body) {
  return BodyReader(urdf, resolver, body).read();
}

}  // namespace monolith
