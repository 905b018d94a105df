#include "scene/urdf_body.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "scene/body_name.h"
#include "scene/mass_properties.h"
#include "scene/urdf_collision.h"
#include "scene/urdf_errors.h"
#include "scene/urdf_joint.h"
#include "scene/urdf_parser.h"
#include "scene/urdf_pose.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;

constexpr int kDeepest = 1000;         // joints from the root to a link: trees are gone through recursively
constexpr std::size_t kMostNamed = 4;  // links in a message

// "link "a"", "links "a", "b""
std::string shownLinks(const std::vector<LinkFrame>& links) {
  std::string text = links.size() > 1 ? "links" : "link";
  for (std::size_t i = 0; i < std::min(links.size(), kMostNamed); ++i) {
    text += (i > 0 ? ", \"" : " \"") + links[i].name + "\"";
  }
  return text + (links.size() > kMostNamed ? " and " + std::to_string(links.size() - kMostNamed) + " more" : "");
}

// Gathers bodies from the tree of links.
class BodyReader {
 public:
  BodyReader(const UrdfText& urdf, const SceneResolver& resolver, std::vector<BodyDescription>& bodies)
      : urdf_(urdf), resolver_(resolver), bodies_(bodies), errors_(urdf.source) {}

  std::vector<std::string> read() {
    bodies_.clear();
    addBody(std::nullopt);
    try {
      const urdf::ModelInterfaceSharedPtr model = parseUrdf(urdf_.xml, urdf_.source);
      if (enter(*model->getRoot(), 0)) visit(*model->getRoot(), 0, Isometry3d::Identity(), 0);
      requireOneTree(*model);
      finish();
    } catch (const SceneError& error) {
      errors_.addLine(error.what());
    }
    const std::string xml = withAbsoluteMeshes(urdf_, mesh_files_);
    for (BodyDescription& body : bodies_) body.urdf_xml = xml;
    return errors_.lines();
  }

 private:
  int addBody(const std::optional<JointDescription>& joint) {
    bodies_.emplace_back();
    bodies_.back().source = urdf_.source;
    bodies_.back().joint = joint;
    parts_.emplace_back();
    return static_cast<int>(bodies_.size()) - 1;
  }

  // Whether to go on with this link.
  bool enter(const urdf::Link& link, int depth) {
    if (!visited_.insert(link.name).second) {
      errors_.add("link \"" + link.name + "\" is the child of two joints, or of one that hangs on itself",
                  "expected one tree of links");
      return false;
    }
    if (depth > kDeepest) {
      errors_.add("link \"" + link.name + "\" is more than " + std::to_string(kDeepest) + " joints from the root",
                  "expected a shorter chain");
      return false;
    }
    return true;
  }

  void visit(const urdf::Link& link, int body, const Isometry3d& X_BL, int depth) {
    bodies_[body].links.push_back({link.name, X_BL});
    if (link.inertial) addInertial(link, body, X_BL);
    for (std::size_t i = 0; i < link.collision_array.size(); ++i) {
      const urdf::CollisionSharedPtr& collision = link.collision_array[i];
      if (!collision) continue;
      noteMesh(collision->geometry);
      const std::string name = link.name + "/collision[" + std::to_string(i) + "]";
      const std::optional<Shape> shape = readUrdfCollision(*collision, name, X_BL, urdf_, resolver_, errors_);
      if (shape) bodies_[body].shapes.push_back(*shape);
    }
    for (const urdf::VisualSharedPtr& visual : link.visual_array) {
      if (visual) noteMesh(visual->geometry);
    }
    for (const urdf::LinkSharedPtr& child : link.child_links) {
      if (!enter(*child, depth + 1)) continue;
      const urdf::Joint& joint = *child->parent_joint;
      if (joint.type == urdf::Joint::FIXED) {
        visit(*child, body, X_BL * toEigen(joint.parent_to_joint_origin_transform), depth + 1);
      } else {
        visit(*child, beginBody(joint, body, X_BL), Isometry3d::Identity(), depth + 1);
      }
    }
  }

  int beginBody(const urdf::Joint& joint, int parent, const Isometry3d& X_PL) {
    if (!validBodyName(joint.child_link_name)) {
      errors_.add("link \"" + joint.child_link_name + "\" beyond joint \"" + joint.name + "\"",
                  std::string("expected a name that is ") + kBodyNameRule);
    }
    JointDescription description = readUrdfJoint(joint, X_PL, errors_);
    description.parent = parent;
    return addBody(description);
  }

  void requireOneTree(const urdf::ModelInterface& model) {
    if (!errors_.lines().empty()) return;
    for (const auto& [name, link] : model.links_) {
      if (visited_.count(name) > 0) continue;
      errors_.add("link \"" + name + "\" does not hang on the root, \"" + model.getRoot()->name + "\"",
                  "expected one tree of links");
    }
  }

  void addInertial(const urdf::Link& link, int body, const Isometry3d& X_BL) {
    const urdf::Inertial& inertial = *link.inertial;
    MassProperties part;
    part.mass = inertial.mass;
    part.inertia << inertial.ixx, inertial.ixy, inertial.ixz,  //
        inertial.ixy, inertial.iyy, inertial.iyz,              //
        inertial.ixz, inertial.iyz, inertial.izz;
    if (!std::isfinite(part.mass) || part.mass < 0.0) {
      errors_.add("link \"" + link.name + "\" inertial: mass " + std::to_string(part.mass) + " kg",
                  "expected a mass >= 0");
    } else if (const std::string violation = partViolation(part); !violation.empty()) {
      errors_.addLine(urdf_.source + ": link \"" + link.name + "\" inertial: " + violation);
    }
    parts_[body].push_back(transformed(part, X_BL * toEigen(inertial.origin)));
  }

  void finish() {
    if (!errors_.lines().empty()) return;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      BodyDescription& body = bodies_[i];
      const std::string links = shownLinks(body.links);
      if (body.shapes.empty()) {
        errors_.add(links + ": no <collision>", bodies_.size() > 1
                                                    ? "expected at least one collision shape of every body, those "
                                                      "between movable joints too"
                                                    : "expected at least one collision shape");
      }
      const MassProperties whole = combined(parts_[i]);
      if (const std::string violation = massViolation(whole); !violation.empty()) {
        std::string line = urdf_.source;
        line.append(": ").append(links).append(" inertial");
        errors_.addLine(line.append(body.links.size() > 1 ? " (all together): " : ": ").append(violation));
      }
      body.mass = whole.mass;
      body.p_BBcm = whole.centre;
      body.inertia_Bcm = whole.inertia;
    }
  }

  void noteMesh(const urdf::GeometrySharedPtr& geometry) {
    if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(geometry.get())) mesh_files_.insert(mesh->filename);
  }

  const UrdfText& urdf_;
  const SceneResolver& resolver_;
  std::vector<BodyDescription>& bodies_;
  std::vector<std::vector<MassProperties>> parts_;  // of each body
  std::set<std::string> visited_;
  std::set<std::string> mesh_files_;
  UrdfErrors errors_;
};

}  // namespace

std::vector<std::string> readUrdfBodies(const UrdfText& urdf, const SceneResolver& resolver,
                                        std::vector<BodyDescription>& bodies) {
  return BodyReader(urdf, resolver, bodies).read();
}

}  // namespace monolith
