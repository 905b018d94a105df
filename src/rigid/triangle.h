#pragma once
// Nearest point of a triangle, and on which of its features it lies.

#include <Eigen/Geometry>

namespace monolith {

struct TrianglePoint {
  Eigen::Vector3d point;
  int corner = -1;  // 0..2 if it is a corner
  int edge = -1;    // 0..2 if it is inside edge k, corner k to k + 1
};

inline TrianglePoint nearestOnTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                       const Eigen::Vector3d& c, const Eigen::Vector3d& p) {
  // The Voronoi region of p by the signs of its barycentric coordinates, corners before edges before the face.
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double ab_a = ab.dot(p - a), ac_a = ac.dot(p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return {a, 0, -1};
  const double ab_b = ab.dot(p - b), ac_b = ac.dot(p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return {b, 1, -1};
  const double ab_c = ab.dot(p - c), ac_c = ac.dot(p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return {c, 2, -1};
  const double over_c = ab_a * ac_b - ab_b * ac_a;
  if (over_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return {a + ab_a / (ab_a - ab_b) * ab, -1, 0};
  const double over_b = ab_c * ac_a - ab_a * ac_c;
  if (over_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return {a + ac_a / (ac_a - ac_c) * ac, -1, 2};
  const double over_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (over_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) {
    return {b + from_b / (from_b + from_c) * (c - b), -1, 1};
  }
  const double total = over_a + over_b + over_c;
  return {a + over_b / total * ab + over_c / total * ac, -1, -1};
}

}  // namespace monolith
