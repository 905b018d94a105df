#pragma once
// What rviz shows of the tank: its edges, its floor, and its walls as panes of glass. Never changes.

#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "scene/scene.h"

namespace monolith {

visualization_msgs::MarkerArray makeTankMarkers(const TankDescription& tank, const std::string& world_frame);

}  // namespace monolith
