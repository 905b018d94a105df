#include "rigid/rotation.h"

#include <Eigen/LU>
#include <cmath>
#include <optional>

namespace monolith {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kNewtonIterations = 30;
constexpr int kMostPieces = 1024;

Matrix3d crossMatrix(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// Solves  r(m) = 2/dt I (m - omega) + m x (I m) - torque = 0  for the midpoint m. Nothing if Newton stalls.
std::optional<Vector3d> midpointStep(const Matrix3d& inertia, const Vector3d& omega, const Vector3d& torque,
                                     double dt) {
  const auto residual = [&](const Vector3d& m) -> Vector3d {
    return 2.0 / dt * (inertia * (m - omega)) + m.cross(inertia * m) - torque;
  };
  // Of the size of what round-off leaves in r.
  const auto roundOff = [&](const Vector3d& m) {
    const double rate = 2.0 / dt * (m.norm() + omega.norm()) + m.squaredNorm();
    return 1e-13 * (inertia.norm() * rate + torque.norm());
  };
  Vector3d m = omega;
  Vector3d r = residual(m);
  for (int iteration = 0; iteration < kNewtonIterations; ++iteration) {
    const Matrix3d jacobian = 2.0 / dt * inertia + crossMatrix(m) * inertia - crossMatrix(inertia * m);
    const Vector3d next = m - jacobian.fullPivLu().solve(r);
    const Vector3d next_residual = residual(next);
    const double next_norm = next_residual.norm();
    if (!std::isfinite(next_norm)) return std::nullopt;
    const bool converged = r.norm() <= roundOff(m);
    // Once at round-off, one more step that gains nothing ends it: the energy is as exact as doubles allow.
    if (converged && next_norm >= r.norm()) return Vector3d(2.0 * m - omega);
    // Undamped on purpose: a step size that needs damping may have several roots, and halving dt is safer.
    if (!converged && iteration > 8 && next_norm > r.norm()) return std::nullopt;
    m = next;
    r = next_residual;
    if (r.norm() == 0.0) return Vector3d(2.0 * m - omega);
  }
  if (r.norm() > roundOff(m)) return std::nullopt;
  return Vector3d(2.0 * m - omega);
}

}  // namespace

Eigen::Quaterniond exponential(const Vector3d& rotation) {
  const double half = 0.5 * rotation.norm();
  // sin(x)/x by its series where the quotient would lose digits.
  const double sinc = half < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
  const Vector3d imaginary = 0.5 * sinc * rotation;
  return Eigen::Quaterniond(std::cos(half), imaginary.x(), imaginary.y(), imaginary.z()).normalized();
}

Vector3d gyroscopicStep(const Matrix3d& inertia, const Vector3d& angular_velocity, const Vector3d& torque, double dt) {
  if (dt == 0.0) return angular_velocity;
  for (int pieces = 1; pieces <= kMostPieces; pieces *= 2) {
    Vector3d omega = angular_velocity;
    bool solved = true;
    for (int piece = 0; piece < pieces && solved; ++piece) {
      const std::optional<Vector3d> next = midpointStep(inertia, omega, torque, dt / pieces);
      solved = next.has_value();
      if (solved) omega = *next;
    }
    if (solved) return omega;
  }
  return angular_velocity + dt * inertia.ldlt().solve(torque);
}

}  // namespace monolith
