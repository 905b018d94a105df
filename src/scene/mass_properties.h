#pragma once
// Mass, centre of mass and inertia of links that move as one.

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace monolith {

struct MassProperties {
  double mass = 0.0;                                    // kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();     // m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();    // kg m^2, about the centre of mass
};

// The same properties in the axes of frame A, given in frame C posed at X_AC.
MassProperties transformed(const MassProperties& properties, const Eigen::Isometry3d& X_AC);

// Sum, all in one frame: I = sum I_i + m_i (|r_i|^2 1 - r_i r_i^T), r_i from the common centre of mass.
MassProperties combined(const std::vector<MassProperties>& parts);

// What keeps it from being a rigid body, with the values and what was expected; empty if nothing does.
// Principal moments: positive, each at most the sum of the other two (relative slack 1e-6).
std::string massViolation(const MassProperties& properties);
// Likewise from being a part of one, which may also be a point, a rod or nothing: mass or moments of zero.
std::string partViolation(const MassProperties& properties);

}  // namespace monolith
