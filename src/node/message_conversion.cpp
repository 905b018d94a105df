#include "node/message_conversion.h"

#include <cmath>
#include <cstring>
#include <sstream>

namespace monolith {

using Eigen::Isometry3d;
using Eigen::Vector3d;

geometry_msgs::Vector3 toVector(const Vector3d& v) {
  geometry_msgs::Vector3 out;
  out.x = v.x();
  out.y = v.y();
  out.z = v.z();
  return out;
}

geometry_msgs::Point toPoint(const Vector3d& p) {
  geometry_msgs::Point out;
  out.x = p.x();
  out.y = p.y();
  out.z = p.z();
  return out;
}

geometry_msgs::Pose toPose(const Isometry3d& X) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(X.linear()).normalized();
  geometry_msgs::Pose out;
  out.position = toPoint(X.translation());
  out.orientation.x = q.x();
  out.orientation.y = q.y();
  out.orientation.z = q.z();
  out.orientation.w = q.w();
  return out;
}

geometry_msgs::Transform toTransform(const Isometry3d& X) {
  geometry_msgs::Transform out;
  out.translation = toVector(X.translation());
  out.rotation = toPose(X).orientation;
  return out;
}

geometry_msgs::Twist toTwist(const Vector3d& linear, const Vector3d& angular) {
  geometry_msgs::Twist out;
  out.linear = toVector(linear);
  out.angular = toVector(angular);
  return out;
}

geometry_msgs::Wrench toWrench(const Wrench& wrench) {
  geometry_msgs::Wrench out;
  out.force = toVector(wrench.force);
  out.torque = toVector(wrench.torque);
  return out;
}

Vector3d toEigen(const geometry_msgs::Vector3& v) { return Vector3d(v.x, v.y, v.z); }
Vector3d toEigen(const geometry_msgs::Point& p) { return Vector3d(p.x, p.y, p.z); }

Isometry3d toIsometry(const geometry_msgs::Transform& transform) {
  geometry_msgs::Pose pose;
  pose.position = toPoint(toEigen(transform.translation));
  pose.orientation = transform.rotation;
  return toIsometry(pose);
}

std::string poseViolation(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  if (!toEigen(pose.position).allFinite()) {
    return "position " + shown(toEigen(pose.position)) + ": expected finite numbers";
  }
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (std::abs(norm - 1.0) <= 1e-3) return "";
  std::ostringstream text;
  text << "orientation [" << q.x << ", " << q.y << ", " << q.z << ", " << q.w
       << "]: expected a unit quaternion x, y, z, w";
  return text.str();
}

Isometry3d toIsometry(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  Isometry3d X(Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  X.translation() = toEigen(pose.position);
  return X;
}

std::string shown(const Vector3d& v) {
  std::ostringstream text;
  text << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
  return text.str();
}

monolith_tank::BodyStates toBodyStates(const std_msgs::Header& header, const std::vector<BodyDescription>& bodies,
                                       const std::vector<BodyState>& states) {
  monolith_tank::BodyStates out;
  out.header = header;
  for (std::size_t b = 0; b < states.size(); ++b) {
    out.names.push_back(bodies[b].name);
    out.poses.push_back(toPose(states[b].X_WB));
    out.twists.push_back(toTwist(states[b].velocity, states[b].angular_velocity));
    out.liquid_wrenches.push_back(toWrench(states[b].liquid));
    out.contact_wrenches.push_back(toWrench(states[b].contact));
  }
  return out;
}

nav_msgs::Odometry toOdometry(const std_msgs::Header& header, const std::string& body, const BodyState& state) {
  const Eigen::Matrix3d R_BW = state.X_WB.linear().transpose();
  nav_msgs::Odometry out;
  out.header = header;
  out.child_frame_id = body;
  out.pose.pose = toPose(state.X_WB);
  out.twist.twist = toTwist(R_BW * state.velocity, R_BW * state.angular_velocity);
  return out;
}

sensor_msgs::PointCloud2 toPointCloud(const std_msgs::Header& header, const std::vector<SurfacePoint>& points) {
  sensor_msgs::PointCloud2 out;
  out.header = header;
  for (const char* name : {"x", "y", "z", "normal_x", "normal_y", "normal_z", "vx", "vy", "vz"}) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(out.fields.size() * sizeof(float));
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    out.fields.push_back(field);
  }
  out.height = 1;
  out.width = static_cast<std::uint32_t>(points.size());
  out.point_step = static_cast<std::uint32_t>(out.fields.size() * sizeof(float));
  out.row_step = out.width * out.point_step;
  out.is_dense = true;
  out.data.resize(out.row_step);
  std::uint8_t* at = out.data.data();
  for (const SurfacePoint& point : points) {
    for (const Eigen::Vector3f* part : {&point.position, &point.normal, &point.velocity}) {
      std::memcpy(at, part->data(), 3 * sizeof(float));
      at += 3 * sizeof(float);
    }
  }
  return out;
}

monolith_tank::Statistics toStatistics(const std_msgs::Header& header, const StepReport& report,
                                       double real_time_factor) {
  monolith_tank::Statistics out;
  out.header = header;
  out.step = static_cast<std::uint64_t>(report.step);
  out.time = report.time;
  out.committed = report.committed();
  out.status = toString(report.status);
  out.message = report.message;
  out.substeps = report.substeps;
  out.iterations = report.iterations;
  out.liquid_solves = report.liquid_solves;
  out.residual = report.residual;
  out.divergence = report.divergence;
  out.maximum_speed = report.maximum_speed;
  out.liquid_volume = report.liquid_volume;
  out.volume_correction = report.volume_correction;
  out.kinetic_energy = report.kinetic_energy;
  out.potential_energy = report.potential_energy;
  out.penetration = report.penetration;
  out.liquid = report.model.liquid;
  out.viscosity = report.model.viscosity;
  out.free_surface = report.model.free_surface;
  out.coupled_bodies = report.model.coupled_bodies;
  out.contacts = report.model.contacts;
  out.advection_time = report.times.advection;
  out.contact_time = report.times.contact;
  out.geometry_time = report.times.geometry;
  out.solve_time = report.times.solve;
  out.surface_time = report.times.surface;
  out.total_time = report.times.total;
  out.real_time_factor = real_time_factor;
  return out;
}

}  // namespace monolith
