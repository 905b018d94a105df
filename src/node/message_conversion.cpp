#include "node/message_conversion.h"

#include <cmath>

#include "node/request_error.h"
#include "scene/shown_vector.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kUnitTolerance = 0.01;

Vector3d checked(const Vector3d& v, const std::string& field) {
  if (!v.allFinite()) throw RequestError(field + ": value " + shownVector(v) + ": expected finite numbers");
  return v;
}

}  // namespace

geometry_msgs::Point toPoint(const Vector3d& v) {
  geometry_msgs::Point message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::Vector3 toVector(const Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::Quaternion toQuaternion(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  message.w = q.w();
  return message;
}

geometry_msgs::Pose toPose(const Eigen::Isometry3d& X) {
  geometry_msgs::Pose message;
  message.position = toPoint(X.translation());
  message.orientation = toQuaternion(Eigen::Quaterniond(X.linear()));
  return message;
}

geometry_msgs::Transform toTransform(const Eigen::Isometry3d& X) {
  geometry_msgs::Transform message;
  message.translation = toVector(X.translation());
  message.rotation = toQuaternion(Eigen::Quaterniond(X.linear()));
  return message;
}

geometry_msgs::Twist toTwist(const Vector3d& velocity, const Vector3d& angular_velocity) {
  geometry_msgs::Twist message;
  message.linear = toVector(velocity);
  message.angular = toVector(angular_velocity);
  return message;
}

geometry_msgs::Wrench toWrench(const Wrench& wrench) {
  geometry_msgs::Wrench message;
  message.force = toVector(wrench.force);
  message.torque = toVector(wrench.torque);
  return message;
}

monolith_tank::Statistics toStatistics(const StepReport& report, double real_time_factor) {
  monolith_tank::Statistics message;
  message.step = static_cast<std::uint64_t>(report.step);
  message.time = report.time;
  message.committed = report.committed();
  message.status = toString(report.status);
  message.message = report.message;
  message.substeps = static_cast<std::uint32_t>(report.substeps);
  message.retries = static_cast<std::uint32_t>(report.retries);
  message.iterations = static_cast<std::uint32_t>(report.iterations);
  message.liquid_solves = static_cast<std::uint32_t>(report.liquid_solves);
  message.friction_iterations = static_cast<std::uint32_t>(report.friction_iterations);
  message.rheology_iterations = static_cast<std::uint32_t>(report.rheology_iterations);
  message.residual = report.residual;
  message.contact_residual = report.contact_residual;
  message.divergence = report.divergence;
  message.maximum_speed = report.maximum_speed;
  message.liquid_volume = report.liquid_volume;
  message.volume_correction = report.volume_correction;
  message.kinetic_energy = report.kinetic_energy;
  message.potential_energy = report.potential_energy;
  message.penetration = report.penetration;
  message.liquid = report.model.liquid;
  message.viscosity = report.model.viscosity;
  message.non_newtonian = report.model.non_newtonian;
  message.free_surface = report.model.free_surface;
  message.time_order = static_cast<std::uint32_t>(report.model.time_order);
  message.coupled_bodies = static_cast<std::uint32_t>(report.model.coupled_bodies);
  message.joints = static_cast<std::uint32_t>(report.model.joints);
  message.contacts = static_cast<std::uint32_t>(report.model.contacts);
  message.friction = report.model.friction;
  message.advection_time = report.times.advection;
  message.contact_time = report.times.contact;
  message.geometry_time = report.times.geometry;
  message.solve_time = report.times.solve;
  message.surface_time = report.times.surface;
  message.total_time = report.times.total;
  message.real_time_factor = real_time_factor;
  return message;
}

Vector3d fromMessage(const geometry_msgs::Point& message, const std::string& field) {
  return checked(Vector3d(message.x, message.y, message.z), field);
}

Vector3d fromMessage(const geometry_msgs::Vector3& message, const std::string& field) {
  return checked(Vector3d(message.x, message.y, message.z), field);
}

Eigen::Isometry3d fromMessage(const geometry_msgs::Pose& message, const std::string& field) {
  const geometry_msgs::Quaternion& o = message.orientation;
  Eigen::Quaterniond q(o.w, o.x, o.y, o.z);
  if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance)) {
    throw RequestError(field + ".orientation: value " + shownVector(q.coeffs()) +
                       ": expected a quaternion [x, y, z, w] of length 1");
  }
  q.normalize();
  Eigen::Isometry3d X(q);
  X.translation() = fromMessage(message.position, field + ".position");
  return X;
}

Eigen::Isometry3d fromTransform(const geometry_msgs::Transform& message) {
  const geometry_msgs::Quaternion& o = message.rotation;
  Eigen::Isometry3d X(Eigen::Quaterniond(o.w, o.x, o.y, o.z).normalized());
  X.translation() = Vector3d(message.translation.x, message.translation.y, message.translation.z);
  return X;
}

}  // namespace monolith
