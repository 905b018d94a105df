#pragma once
// What rviz shows of a body: the URDF's visuals with their colours; of a body without any, its collision shapes.

#include <visualization_msgs/Marker.h>

#include <vector>

#include "scene/scene.h"

namespace monolith {

// A marker of the body, and where it is in the body's frame.
struct BodyMarker {
  Eigen::Isometry3d X_BV;
  visualization_msgs::Marker marker;  // all but header and pose
};

// `index` picks the colour of a body that has none of its own. Visuals that markers cannot show (a mesh that names no
// file) are left out with a warning in `warnings`.
std::vector<BodyMarker> makeBodyMarkers(const BodyDescription& body, int index, std::vector<std::string>& warnings);

}  // namespace monolith
