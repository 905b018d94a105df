#include "node/body_markers.h"

#include <urdf_model/link.h>

#include "node/message_conversion.h"
#include "scene/urdf_parser.h"

namespace monolith {
namespace {

using visualization_msgs::Marker;

// Of bodies without a colour; told apart also by those who do not see all colours (after Okabe and Ito).
constexpr float kPalette[][3] = {{0.90f, 0.62f, 0.00f}, {0.00f, 0.62f, 0.45f}, {0.84f, 0.37f, 0.00f},
                                 {0.80f, 0.47f, 0.65f}, {0.94f, 0.89f, 0.26f}, {0.00f, 0.45f, 0.70f}};
constexpr int kPaletteSize = sizeof(kPalette) / sizeof(kPalette[0]);

std_msgs::ColorRGBA paletteColour(int index) {
  std_msgs::ColorRGBA colour;
  colour.r = kPalette[index % kPaletteSize][0];
  colour.g = kPalette[index % kPaletteSize][1];
  colour.b = kPalette[index % kPaletteSize][2];
  colour.a = 1.0f;
  return colour;
}

void setScale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

Eigen::Isometry3d toIsometry(const urdf::Pose& pose) {
  Eigen::Isometry3d X(Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z));
  X.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return X;
}

// False if the geometry cannot be shown.
bool setGeometry(const urdf::Geometry& geometry, bool has_colour, Marker& marker) {
  switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const auto& size = static_cast<const urdf::Box&>(geometry).dim;
      marker.type = Marker::CUBE;
      setScale(marker, size.x, size.y, size.z);
      return true;
    }
    case urdf::Geometry::SPHERE: {
      const double diameter = 2.0 * static_cast<const urdf::Sphere&>(geometry).radius;
      marker.type = Marker::SPHERE;
      setScale(marker, diameter, diameter, diameter);
      return true;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      marker.type = Marker::CYLINDER;
      setScale(marker, 2.0 * cylinder.radius, 2.0 * cylinder.radius, cylinder.length);
      return true;
    }
    case urdf::Geometry::MESH: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      marker.type = Marker::MESH_RESOURCE;
      marker.mesh_resource = mesh.filename;
      marker.mesh_use_embedded_materials = !has_colour;
      setScale(marker, mesh.scale.x, mesh.scale.y, mesh.scale.z);
      return !mesh.filename.empty();
    }
  }
  return false;
}

void setShape(const Shape& shape, Marker& marker) {
  switch (shape.kind) {
    case Shape::Kind::kBox:
      marker.type = Marker::CUBE;
      setScale(marker, shape.box_size.x(), shape.box_size.y(), shape.box_size.z());
      return;
    case Shape::Kind::kSphere:
      marker.type = Marker::SPHERE;
      setScale(marker, 2.0 * shape.radius, 2.0 * shape.radius, 2.0 * shape.radius);
      return;
    case Shape::Kind::kCylinder:
      marker.type = Marker::CYLINDER;
      setScale(marker, 2.0 * shape.radius, 2.0 * shape.radius, shape.length);
      return;
    case Shape::Kind::kMesh:
      marker.type = Marker::TRIANGLE_LIST;
      setScale(marker, 1.0, 1.0, 1.0);
      for (const Eigen::Vector3i& triangle : shape.mesh->triangles) {
        for (int corner = 0; corner < 3; ++corner)
          marker.points.push_back(toPoint(shape.mesh->vertices[triangle[corner]]));
      }
      return;
  }
}

// A material that only has a texture, which markers cannot show, has the colour that the parser begins with.
bool hasColour(const urdf::MaterialSharedPtr& material) {
  if (!material) return false;
  const urdf::Color& c = material->color;
  return material->texture_filename.empty() || c.r != 0.0f || c.g != 0.0f || c.b != 0.0f || c.a != 1.0f;
}

std::vector<BodyMarker> visualMarkers(const BodyDescription& body, int index, std::vector<std::string>& warnings) {
  std::vector<BodyMarker> markers;
  const urdf::ModelInterfaceSharedPtr model = parseUrdf(body.urdf_xml, body.source);
  for (const LinkFrame& frame : body.links) {
    const urdf::LinkConstSharedPtr link = model->getLink(frame.name);
    if (!link) continue;
    for (const urdf::VisualSharedPtr& visual : link->visual_array) {
      if (!visual || !visual->geometry) continue;
      BodyMarker out;
      out.X_BV = frame.X_BL * toIsometry(visual->origin);
      out.marker.color = paletteColour(index);
      const bool has_colour = hasColour(visual->material);
      if (has_colour) {
        const urdf::Color& colour = visual->material->color;
        out.marker.color.r = colour.r;
        out.marker.color.g = colour.g;
        out.marker.color.b = colour.b;
        out.marker.color.a = colour.a;
      }
      if (setGeometry(*visual->geometry, has_colour, out.marker)) {
        markers.push_back(out);
      } else {
        warnings.push_back(body.source + ": link \"" + frame.name +
                           "\": visual cannot be shown: expected box, sphere, "
                           "cylinder or a mesh with a file");
      }
    }
  }
  return markers;
}

}  // namespace

std::vector<BodyMarker> makeBodyMarkers(const BodyDescription& body, int index, std::vector<std::string>& warnings) {
  std::vector<BodyMarker> markers = visualMarkers(body, index, warnings);
  if (markers.empty()) {
    for (const Shape& shape : body.shapes) {
      BodyMarker out;
      out.X_BV = shape.X_BG;
      out.marker.color = paletteColour(index);
      setShape(shape, out.marker);
      markers.push_back(out);
    }
  }
  for (std::size_t i = 0; i < markers.size(); ++i) {
    markers[i].marker.ns = body.name;
    markers[i].marker.id = static_cast<int>(i);
    markers[i].marker.action = Marker::ADD;
  }
  return markers;
}

}  // namespace monolith
