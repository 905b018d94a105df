#include "geometry/wall_thickness.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

constexpr double kLeastAdvance = 0.05;  // spacings: so closely is the far side found

// Along a ray from the surface, as far as the solid surely goes on at once.
double thicknessBehind(const SignedDistance& solid, const Eigen::Vector3d& foot, const Eigen::Vector3d& out,
                       double spacing, double most) {
  double depth = kLeastAdvance * spacing;
  while (depth < most) {
    const double distance = solid.distance(foot - depth * out);
    if (distance >= 0.0) return depth;
    depth += std::max(-distance, kLeastAdvance * spacing);
  }
  return most;
}

}  // namespace

std::vector<double> wallThickness(const SignedDistance& solid, double spacing, double most) {
  const Eigen::AlignedBox3d box = solid.bounds();
  const Eigen::Vector3d low = box.min() - Eigen::Vector3d::Constant(0.5 * spacing);
  const Eigen::Array3i count = ((box.max() - low).array() / spacing).ceil().cast<int>() + 1;
  std::vector<std::vector<double>> planes(std::max(0, count[2]));
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        const Eigen::Vector3d point = low + spacing * Eigen::Vector3d(i, j, k);
        const DistanceSample s = solid.sample(point);
        if (std::abs(s.distance) > 0.5 * spacing) continue;
        planes[k].push_back(thicknessBehind(solid, point - s.distance * s.gradient, s.gradient, spacing, most));
      }
    }
  }
  std::vector<double> all;
  for (const auto& plane : planes) all.insert(all.end(), plane.begin(), plane.end());
  std::sort(all.begin(), all.end());
  return all;
}

bool isThinner(const SignedDistance& solid, const Eigen::Vector3d& point, double thickness) {
  const DistanceSample s = solid.sample(point);
  return solid.distance(point - (s.distance + thickness) * s.gradient) >= 0.0;
}

}  // namespace monolith
