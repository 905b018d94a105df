// Sums of links against the analytic properties of the whole that they make up.

#include "scene/mass_properties.h"

#include <gtest/gtest.h>

#include <cmath>

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

MassProperties cuboid(double density, const Vector3d& size, const Vector3d& centre) {
  MassProperties properties;
  properties.mass = density * size.prod();
  properties.centre = centre;
  const Vector3d squares = size.array().square();
  properties.inertia = (properties.mass / 12.0 * (Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
  return properties;
}

TEST(MassProperties, CuboidCutIntoUnequalPartsIsTheCuboid) {
  const Vector3d offset(0.4, -0.2, 0.9);
  const MassProperties whole = cuboid(700.0, Vector3d(1.0, 0.4, 0.3), offset);
  const MassProperties left = cuboid(700.0, Vector3d(0.3, 0.4, 0.3), offset + Vector3d(-0.35, 0.0, 0.0));
  const MassProperties low = cuboid(700.0, Vector3d(0.7, 0.4, 0.1), offset + Vector3d(0.15, 0.0, -0.1));
  const MassProperties high = cuboid(700.0, Vector3d(0.7, 0.4, 0.2), offset + Vector3d(0.15, 0.0, 0.05));
  const MassProperties sum = combined({left, low, high});
  EXPECT_NEAR(sum.mass, whole.mass, 1e-12);
  EXPECT_LT((sum.centre - whole.centre).norm(), 1e-14);
  EXPECT_LT((sum.inertia - whole.inertia).norm(), 1e-12 * whole.inertia.norm());
}

TEST(MassProperties, TransformTurnsTheInertiaWithTheBody) {
  const MassProperties properties = cuboid(1.0, Vector3d(1.0, 2.0, 3.0), Vector3d(0.1, 0.2, 0.3));
  Isometry3d X = Isometry3d::Identity();
  X.linear() = Eigen::AngleAxisd(M_PI / 2.0, Vector3d::UnitZ()).toRotationMatrix();
  X.translation() = Vector3d(5.0, 0.0, 0.0);
  const MassProperties turned = transformed(properties, X);
  const MassProperties expected = cuboid(1.0, Vector3d(2.0, 1.0, 3.0), Vector3d(4.8, 0.1, 0.3));
  EXPECT_LT((turned.centre - expected.centre).norm(), 1e-14);
  EXPECT_LT((turned.inertia - expected.inertia).norm(), 1e-13);
}

TEST(MassProperties, MasslessPartsChangeNothing) {
  const MassProperties properties = cuboid(1.0, Vector3d(1.0, 2.0, 3.0), Vector3d(0.1, 0.2, 0.3));
  const MassProperties sum = combined({MassProperties(), properties, MassProperties()});
  EXPECT_EQ(sum.mass, properties.mass);
  EXPECT_LT((sum.inertia - properties.inertia).norm(), 1e-14);
  EXPECT_EQ(combined({}).mass, 0.0);
}

MassProperties turnedBody(double mass, const Vector3d& moments) {
  MassProperties properties;
  properties.mass = mass;
  const Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  properties.inertia = R * moments.asDiagonal() * R.transpose();
  return properties;
}

std::string violation(double mass, const Vector3d& moments) { return massViolation(turnedBody(mass, moments)); }

TEST(MassProperties, ViolationsAreNamed) {
  EXPECT_EQ(violation(1.0, Vector3d(1.0, 2.0, 2.5)), "");
  EXPECT_EQ(violation(1.0, Vector3d(1.0, 1.0, 2.0)), "");        // a flat disc, on the limit
  EXPECT_EQ(violation(1.0, Vector3d(1.0, 1.0, 2.0000005)), "");  // and within the slack
  EXPECT_NE(violation(1.0, Vector3d(1.0, 1.0, 2.00001)).find("triangle inequality"), std::string::npos);
  EXPECT_NE(violation(1.0, Vector3d(-1.0, 2.0, 2.0)).find("positive definite"), std::string::npos);
  EXPECT_NE(violation(1.0, Vector3d::Zero()).find("positive definite"), std::string::npos);
  EXPECT_NE(violation(0.0, Vector3d::Ones()).find("mass 0 kg"), std::string::npos);
  EXPECT_NE(violation(-2.0, Vector3d::Ones()).find("mass -2 kg"), std::string::npos);
  EXPECT_NE(violation(std::nan(""), Vector3d::Ones()).find("finite mass"), std::string::npos);
  EXPECT_NE(violation(1.0, Vector3d(1.0, std::nan(""), 1.0)).find("not finite"), std::string::npos);
}

TEST(MassProperties, PartsMayBePointsRodsOrNothing) {
  const auto ofPart = [](double mass, const Vector3d& moments) { return partViolation(turnedBody(mass, moments)); };
  EXPECT_EQ(ofPart(1.0, Vector3d(1.0, 2.0, 2.5)), "");
  EXPECT_EQ(ofPart(1.0, Vector3d(0.0, 2.0, 2.0)), "");  // a rod, turned: zero but for round-off
  EXPECT_EQ(ofPart(1.0, Vector3d::Zero()), "");
  EXPECT_EQ(ofPart(0.0, Vector3d::Zero()), "");
  EXPECT_NE(ofPart(1.0, Vector3d(-1e-6, 2.0, 2.0)).find("none below zero"), std::string::npos);
  EXPECT_NE(ofPart(1.0, Vector3d(0.0, 0.0, 2.0)).find("triangle inequality"), std::string::npos);
  EXPECT_NE(ofPart(0.0, Vector3d::Ones()).find("mass 0 kg with an inertia"), std::string::npos);
  EXPECT_NE(ofPart(1.0, Vector3d(1.0, std::nan(""), 1.0)).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace monolith
