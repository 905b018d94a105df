// Messages: there and back, and what is refused; the surface's bytes; markers.

#include "node/message_conversion.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "node/body_markers.h"
#include "node/point_cloud.h"
#include "node/request_error.h"
#include "node/tank_markers.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Isometry3d somePose() {
  Isometry3d X(Eigen::AngleAxisd(2.7, Vector3d(1.0, 2.0, -1.0).normalized()));
  X.translation() = Vector3d(0.3, -0.2, 0.5);
  return X;
}

std::string errorOf(const geometry_msgs::Pose& pose) {
  try {
    fromMessage(pose, "pose");
  } catch (const RequestError& error) {
    return error.what();
  }
  return "";
}

TEST(MessageConversion, PosesComeBack) {
  EXPECT_TRUE(fromMessage(toPose(somePose()), "pose").isApprox(somePose()));
  EXPECT_TRUE(fromTransform(toTransform(somePose())).isApprox(somePose()));
}

TEST(MessageConversion, NearlyUnitQuaternionsAreNormalisedAndOthersRefused) {
  geometry_msgs::Pose pose = toPose(somePose());
  pose.orientation.w *= 1.005;
  const Eigen::Matrix3d R = fromMessage(pose, "pose").linear();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  for (const double w : {0.0, 2.0, kNaN, kInfinity}) {
    pose = geometry_msgs::Pose();
    pose.orientation.w = w;
    EXPECT_NE(errorOf(pose).find("pose.orientation"), std::string::npos);
  }
}

TEST(MessageConversion, NumbersThatAreNotFiniteAreNamed) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    geometry_msgs::Pose pose = toPose(somePose());
    pose.position.y = bad;
    EXPECT_NE(errorOf(pose).find("pose.position: value [0.3, "), std::string::npos) << errorOf(pose);
    EXPECT_THROW(fromMessage(toVector(Vector3d(0.0, 0.0, bad)), "v"), RequestError);
  }
}

TEST(MessageConversion, StatisticsCarryEveryStage) {
  StepReport report;
  report.status = SolveStatus::kInconsistent;
  report.message = "sealed";
  report.step = 7;
  report.times.surface = 0.25;
  report.model.contacts = 3;
  report.model.friction = true;
  report.model.joints = 3;
  report.friction_iterations = 6;
  report.rheology_iterations = 9;
  report.retries = 2;
  report.model.non_newtonian = true;
  const monolith_tank::Statistics message = toStatistics(report, 0.5);
  EXPECT_FALSE(message.committed);
  EXPECT_EQ(message.status, "inconsistent");
  EXPECT_EQ(message.message, "sealed");
  EXPECT_EQ(message.step, 7u);
  EXPECT_EQ(message.surface_time, 0.25);
  EXPECT_EQ(message.contacts, 3u);
  EXPECT_TRUE(message.friction);
  EXPECT_EQ(message.joints, 3u);
  EXPECT_EQ(message.friction_iterations, 6u);
  EXPECT_EQ(message.rheology_iterations, 9u);
  EXPECT_EQ(message.retries, 2u);
  EXPECT_TRUE(message.non_newtonian);
  EXPECT_EQ(message.real_time_factor, 0.5);
}

TEST(PointCloud, FieldsAreWhereTheyAreSaidToBe) {
  std::vector<SurfacePoint> points(2);
  for (int i = 0; i < 9; ++i) {
    SurfacePoint& point = points[1];
    Eigen::Vector3f& part = i < 3 ? point.position : i < 6 ? point.normal : point.velocity;
    part[i % 3] = 10.0f + static_cast<float>(i);
  }
  const sensor_msgs::PointCloud2 cloud = toPointCloud(points);
  EXPECT_EQ(cloud.width * cloud.height, 2u);
  EXPECT_EQ(cloud.data.size(), 2u * cloud.point_step);
  ASSERT_EQ(cloud.fields.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    float value;
    std::memcpy(&value, &cloud.data[cloud.point_step + cloud.fields[i].offset], sizeof value);
    EXPECT_EQ(value, 10.0f + static_cast<float>(i)) << cloud.fields[i].name;
  }
  EXPECT_TRUE(toPointCloud({}).data.empty());
}

BodyDescription described(const std::string& visuals) {
  BodyDescription body;
  body.name = "probe";
  body.source = "probe.urdf";
  body.urdf_xml = "<robot name='probe'><link name='base'>" + visuals + "</link></robot>";
  body.links = {{"base", somePose()}};
  Shape sphere;
  sphere.kind = Shape::Kind::kSphere;
  sphere.radius = 0.1;
  body.shapes = {sphere};
  return body;
}

TEST(BodyMarkers, ShowTheVisualsWithTheirColoursAndPlaces) {
  std::vector<std::string> warnings;
  const auto markers = makeBodyMarkers(
      described("<visual><origin xyz='0 0 1'/><geometry><cylinder radius='0.2' length='3'/></geometry>"
                "<material name='m'><color rgba='0.1 0.2 0.3 0.4'/></material></visual>"
                "<visual><geometry><mesh filename='package://p/m.stl' scale='2 2 2'/></geometry></visual>"),
      0, warnings);
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(markers[0].marker.type, visualization_msgs::Marker::CYLINDER);
  EXPECT_DOUBLE_EQ(markers[0].marker.scale.x, 0.4);
  EXPECT_DOUBLE_EQ(markers[0].marker.scale.z, 3.0);
  EXPECT_FLOAT_EQ(markers[0].marker.color.a, 0.4f);
  EXPECT_TRUE(markers[0].X_BV.translation().isApprox(somePose() * Vector3d::UnitZ()));
  EXPECT_EQ(markers[1].marker.mesh_resource, "package://p/m.stl");
  EXPECT_TRUE(markers[1].marker.mesh_use_embedded_materials);
  EXPECT_NE(markers[0].marker.id, markers[1].marker.id);
}

TEST(BodyMarkers, AMaterialWithATextureAloneHasNoColour) {
  const std::string material = "<material name='m'><texture filename='wood.png'/></material></visual>";
  std::vector<std::string> warnings;
  const auto markers = makeBodyMarkers(
      described("<visual><geometry><sphere radius='0.1'/></geometry>" + material +
                "<visual><geometry><mesh filename='package://p/m.dae'/></geometry>" + material +
                "<visual><geometry><sphere radius='0.1'/></geometry>"
                "<material name='black'><color rgba='0 0 0 1'/></material></visual>"),
      3, warnings);
  ASSERT_EQ(markers.size(), 3u);
  EXPECT_EQ(markers[0].marker.color, makeBodyMarkers(described(""), 3, warnings)[0].marker.color);
  EXPECT_GT(markers[0].marker.color.r, 0.0f);
  EXPECT_TRUE(markers[1].marker.mesh_use_embedded_materials);
  EXPECT_EQ(markers[2].marker.color.r, 0.0f);
}

TEST(BodyMarkers, WithoutVisualsShowTheCollisionShapes) {
  std::vector<std::string> warnings;
  const auto markers = makeBodyMarkers(described(""), 3, warnings);
  ASSERT_EQ(markers.size(), 1u);
  EXPECT_EQ(markers[0].marker.type, visualization_msgs::Marker::SPHERE);
  EXPECT_DOUBLE_EQ(markers[0].marker.scale.y, 0.2);
  EXPECT_EQ(markers[0].marker.color.a, 1.0f);
}

TEST(TankMarkers, OutlineIsTheTanksTwelveEdges) {
  TankDescription tank;
  tank.size = Vector3d(1.0, 2.0, 3.0);
  tank.origin = Vector3d(-0.5, -1.0, 0.0);
  const auto markers = makeTankMarkers(tank, "world").markers;
  ASSERT_EQ(markers.size(), 6u);
  ASSERT_EQ(markers[0].points.size(), 24u);
  double length = 0.0;
  for (int edge = 0; edge < 12; ++edge) {
    const Vector3d start = fromMessage(markers[0].points[2 * edge], "");
    length += (fromMessage(markers[0].points[2 * edge + 1], "") - start).norm();
    EXPECT_TRUE(Eigen::AlignedBox3d(tank.origin, tank.origin + tank.size).contains(start));
  }
  EXPECT_NEAR(length, 4.0 * (1.0 + 2.0 + 3.0), 1e-12);
  tank.periodic[0] = true;
  EXPECT_EQ(makeTankMarkers(tank, "world").markers.size(), 4u);
}

}  // namespace
}  // namespace monolith
