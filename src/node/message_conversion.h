#pragma once
// Between Eigen and ROS messages. Whatever comes in is checked: RequestError names the field and its value.

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/Wrench.h>
#include <monolith_tank/Statistics.h>
#include <ros/time.h>

#include <Eigen/Geometry>
#include <string>

#include "rigid/integration.h"
#include "simulation/statistics.h"

namespace monolith {

geometry_msgs::Point toPoint(const Eigen::Vector3d& v);
geometry_msgs::Vector3 toVector(const Eigen::Vector3d& v);
geometry_msgs::Quaternion toQuaternion(const Eigen::Quaterniond& q);
geometry_msgs::Pose toPose(const Eigen::Isometry3d& X);
geometry_msgs::Transform toTransform(const Eigen::Isometry3d& X);
geometry_msgs::Twist toTwist(const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity);
geometry_msgs::Wrench toWrench(const Wrench& wrench);
// All but the header.
monolith_tank::Statistics toStatistics(const StepReport& report, double real_time_factor);

// `field` is how the caller knows the value, for example "wrench.force".
Eigen::Vector3d fromMessage(const geometry_msgs::Point& message, const std::string& field);
Eigen::Vector3d fromMessage(const geometry_msgs::Vector3& message, const std::string& field);
// A quaternion within 1 % of unit length is normalised.
Eigen::Isometry3d fromMessage(const geometry_msgs::Pose& message, const std::string& field);
Eigen::Isometry3d fromTransform(const geometry_msgs::Transform& message);

}  // namespace monolith
