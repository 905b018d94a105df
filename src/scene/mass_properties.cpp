#include "scene/mass_properties.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

namespace monolith {

MassProperties transformed(const MassProperties& properties, const Eigen::Isometry3d& X_AC) {
  const Eigen::Matrix3d R = X_AC.linear();
  return {properties.mass, X_AC * properties.centre, R * properties.inertia * R.transpose()};
}

MassProperties combined(const std::vector<MassProperties>& parts) {
  MassProperties whole;
  for (const MassProperties& part : parts) {
    whole.mass += part.mass;
    whole.centre += part.mass * part.centre;
  }
  if (whole.mass != 0.0) whole.centre /= whole.mass;
  for (const MassProperties& part : parts) {
    const Eigen::Vector3d r = part.centre - whole.centre;
    whole.inertia += part.inertia;
    whole.inertia += part.mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return whole;
}

namespace {

constexpr double kLeastMoment = 1e-12;  // of the largest; less is zero

// may_vanish: moments of zero will do.
std::string inertiaViolation(const Eigen::Matrix3d& inertia, bool may_vanish) {
  if (!inertia.allFinite()) return "inertia is not finite: expected finite moments";
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  std::ostringstream text;
  text << "principal moments of inertia " << moments[0] << ", " << moments[1] << ", " << moments[2] << " kg m^2: ";
  const double round_off = kLeastMoment * moments.cwiseAbs().maxCoeff();
  if (may_vanish ? moments[0] < -round_off : !(moments[0] > round_off)) {
    return text.str() + (may_vanish ? "expected none below zero" : "expected a positive definite inertia");
  }
  if (moments[0] + moments[1] < moments[2] * (1.0 - 1e-6)) {
    return text.str() + "expected each to be at most the sum of the other two (triangle inequality)";
  }
  return std::string();
}

}  // namespace

std::string massViolation(const MassProperties& properties) {
  std::ostringstream text;
  if (!std::isfinite(properties.mass) || !(properties.mass > 0.0)) {
    text << "mass " << properties.mass << " kg: expected a finite mass > 0";
    return text.str();
  }
  if (!properties.centre.allFinite()) return "centre of mass is not finite: expected finite coordinates";
  return inertiaViolation(properties.inertia, false);
}

std::string partViolation(const MassProperties& properties) {
  if (properties.mass == 0.0 && !properties.inertia.isZero(0.0)) {
    return "mass 0 kg with an inertia: expected a mass > 0, or no inertia";
  }
  return inertiaViolation(properties.inertia, true);
}

}  // namespace monolith
