#include "node/tank_markers.h"

#include "node/message_conversion.h"

namespace monolith {
namespace {

using Eigen::Vector3d;
using visualization_msgs::Marker;

constexpr double kEdgeThickness = 0.006;  // of the longest edge
constexpr double kPaneThickness = 0.002;  // likewise

Marker makeMarker(const std::string& world_frame, const std::string& name, int id) {
  Marker marker;
  marker.header.frame_id = world_frame;  // no stamp: rviz then shows it at any time
  marker.ns = name;
  marker.id = id;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  return marker;
}

void setColour(Marker& marker, float r, float g, float b, float a) {
  marker.color.r = r;
  marker.color.g = g;
  marker.color.b = b;
  marker.color.a = a;
}

Marker makeEdges(const TankDescription& tank, const std::string& world_frame) {
  Marker edges = makeMarker(world_frame, "edges", 0);
  edges.type = Marker::LINE_LIST;
  edges.scale.x = kEdgeThickness * tank.size.maxCoeff();
  setColour(edges, 0.25f, 0.30f, 0.35f, 1.0f);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 4; ++side) {
      Vector3d start = tank.origin;
      start[(axis + 1) % 3] += (side & 1) ? tank.size[(axis + 1) % 3] : 0.0;
      start[(axis + 2) % 3] += (side & 2) ? tank.size[(axis + 2) % 3] : 0.0;
      edges.points.push_back(toPoint(start));
      edges.points.push_back(toPoint(start + tank.size[axis] * Vector3d::Unit(axis)));
    }
  }
  return edges;
}

// Just outside the tank, so that nothing in it touches the pane.
Marker makePane(const TankDescription& tank, const std::string& world_frame, int axis, bool upper, int id) {
  Marker pane = makeMarker(world_frame, axis == 2 ? "floor" : "walls", id);
  pane.type = Marker::CUBE;
  const double thickness = kPaneThickness * tank.size.maxCoeff();
  Vector3d size = tank.size;
  size[axis] = thickness;
  Vector3d centre = tank.origin + 0.5 * tank.size;
  centre[axis] = upper ? tank.origin[axis] + tank.size[axis] + 0.5 * thickness : tank.origin[axis] - 0.5 * thickness;
  pane.pose.position = toPoint(centre);
  pane.scale = toVector(size);
  if (axis == 2) {
    setColour(pane, 0.95f, 0.96f, 0.97f, 1.0f);
  } else {
    setColour(pane, 0.70f, 0.85f, 0.95f, 0.10f);
  }
  return pane;
}

}  // namespace

visualization_msgs::MarkerArray makeTankMarkers(const TankDescription& tank, const std::string& world_frame) {
  visualization_msgs::MarkerArray array;
  array.markers.push_back(makeEdges(tank, world_frame));
  array.markers.push_back(makePane(tank, world_frame, 2, false, 0));
  for (int axis = 0; axis < 2; ++axis) {
    if (tank.periodic[axis]) continue;
    for (const bool upper : {false, true}) {
      array.markers.push_back(makePane(tank, world_frame, axis, upper, 2 * axis + upper));
    }
  }
  return array;
}

}  // namespace monolith
