#include "node/point_cloud.h"

#include <cstring>

namespace monolith {
namespace {

constexpr const char* kFields[] = {"x", "y", "z", "normal_x", "normal_y", "normal_z", "vx", "vy", "vz"};

}  // namespace

sensor_msgs::PointCloud2 toPointCloud(const std::vector<SurfacePoint>& points) {
  sensor_msgs::PointCloud2 cloud;
  for (const char* name : kFields) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
    cloud.point_step += sizeof(float);
  }
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points.size());
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_dense = true;
  cloud.data.resize(cloud.row_step);
  std::uint8_t* out = cloud.data.data();
  for (const SurfacePoint& point : points) {
    for (const Eigen::Vector3f* v : {&point.position, &point.normal, &point.velocity}) {
      std::memcpy(out, v->data(), 3 * sizeof(float));
      out += 3 * sizeof(float);
    }
  }
  return cloud;
}

}  // namespace monolith
