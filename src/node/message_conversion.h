#pragma once
// Between the library's types and ROS messages.

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/Wrench.h>
#include <monolith_tank/BodyStates.h>
#include <monolith_tank/Statistics.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "simulation/simulation.h"

namespace monolith {

geometry_msgs::Vector3 toVector(const Eigen::Vector3d& v);
geometry_msgs::Point toPoint(const Eigen::Vector3d& p);
geometry_msgs::Pose toPose(const Eigen::Isometry3d& X);
geometry_msgs::Transform toTransform(const Eigen::Isometry3d& X);
geometry_msgs::Twist toTwist(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular);
geometry_msgs::Wrench toWrench(const Wrench& wrench);

Eigen::Vector3d toEigen(const geometry_msgs::Vector3& v);
Eigen::Vector3d toEigen(const geometry_msgs::Point& p);
Eigen::Isometry3d toIsometry(const geometry_msgs::Transform& transform);

// Why a pose is none ("orientation [0, 0, 0, 0]: expected a unit quaternion"); empty if it is one. A norm off 1 by up
// to 0.001 is taken for rounding.
std::string poseViolation(const geometry_msgs::Pose& pose);
// Of a pose without violation.
Eigen::Isometry3d toIsometry(const geometry_msgs::Pose& pose);

// "[1, 2, 3]", for messages.
std::string shown(const Eigen::Vector3d& v);

monolith_tank::BodyStates toBodyStates(const std_msgs::Header& header, const std::vector<BodyDescription>& bodies,
                                       const std::vector<BodyState>& states);
// Twist in the child frame, as nav_msgs has it.
nav_msgs::Odometry toOdometry(const std_msgs::Header& header, const std::string& body, const BodyState& state);
// float32 x y z, normal_x normal_y normal_z, vx vy vz.
sensor_msgs::PointCloud2 toPointCloud(const std_msgs::Header& header, const std::vector<SurfacePoint>& points);
monolith_tank::Statistics toStatistics(const std_msgs::Header& header, const StepReport& report,
                                       double real_time_factor);

}  // namespace monolith
