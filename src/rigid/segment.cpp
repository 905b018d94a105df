#include "rigid/segment.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace monolith {

using Eigen::Vector3d;

namespace {

double clampUnit(double t) { return std::min(std::max(t, 0.0), 1.0); }

double parameterOf(const Vector3d& point, const Vector3d& origin, const Vector3d& edge) {
  const double squared = edge.squaredNorm();
  return squared > 0.0 ? (point - origin).dot(edge) / squared : 0.0;
}

}  // namespace

PointPair nearestPoints(const Vector3d& p0, const Vector3d& p1, const Vector3d& q0, const Vector3d& q1) {
  const Vector3d u = p1 - p0, v = q1 - q0;
  const Vector3d across = u.cross(v);
  const double determinant = across.squaredNorm();
  double s = 0.0;
  if (determinant > 1e-16 * u.squaredNorm() * v.squaredNorm()) {
    s = clampUnit((q0 - p0).cross(v).dot(across) / determinant);
  } else {
    const double at_q0 = clampUnit(parameterOf(q0, p0, u)), at_q1 = clampUnit(parameterOf(q1, p0, u));
    s = 0.5 * (at_q0 + at_q1);
  }
  // Nearest on q to that point, then back: exact, since only one clamp can be active at the end.
  const double t = clampUnit(parameterOf(p0 + s * u, q0, v));
  s = clampUnit(parameterOf(q0 + t * v, p0, u));
  return {p0 + s * u, q0 + t * v};
}

bool parallelOverlap(const std::vector<Vector3d>& p, const std::vector<Vector3d>& q, double sine,
                     std::vector<Vector3d>& on_p, std::vector<Vector3d>& on_q) {
  if (p.size() != 2 || q.size() != 2) return false;
  const Vector3d u = p[1] - p[0], v = q[1] - q[0];
  if (u.cross(v).norm() >= sine * u.norm() * v.norm()) return false;
  const double at_q0 = parameterOf(q[0], p[0], u), at_q1 = parameterOf(q[1], p[0], u);
  const double first = std::max(0.0, std::min(at_q0, at_q1)), last = std::min(1.0, std::max(at_q0, at_q1));
  if (first >= last) return false;
  for (const double s : {first, last}) {
    on_p.push_back(p[0] + s * u);
    on_q.push_back(q[0] + clampUnit(parameterOf(on_p.back(), q[0], v)) * v);
  }
  return true;
}

}  // namespace monolith
