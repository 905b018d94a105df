#pragma once
// The liquid's surface as a point cloud with fields x y z normal_x normal_y normal_z vx vy vz, float32, SI units. The
// names of the normal are those that PCL reads.

#include <sensor_msgs/PointCloud2.h>

#include <vector>

#include "simulation/simulation.h"

namespace monolith {

// All but the header. One row; no invalid points.
sensor_msgs::PointCloud2 toPointCloud(const std::vector<SurfacePoint>& points);

}  // namespace monolith
