#include "geometry/cube_fraction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace monolith {

double insideFraction(double distance, const Eigen::Vector3d& gradient, double width) {
  const Eigen::Vector3d slope = gradient.cwiseAbs();
  const double total = slope.sum();
  if (!(total > 0.0)) return distance < 0.0 ? 1.0 : 0.0;
  // The plane n . x = alpha in the unit cube with n >= 0, sum n = 1; the solid is below it.
  std::array<double, 3> n = {slope[0] / total, slope[1] / total, slope[2] / total};
  std::sort(n.begin(), n.end());
  const double alpha = 0.5 - distance * gradient.norm() / (width * total);
  if (alpha <= 0.0) return 0.0;
  if (alpha >= 1.0) return 1.0;
  const bool low = alpha <= 0.5;
  const double a = low ? alpha : 1.0 - alpha;
  const double n1 = n[0], n2 = n[1], n3 = n[2], n12 = n1 + n2;
  double volume = 0.0;
  const auto cube = [](double x) { return x * x * x; };
  // Thin slopes make the cubic forms divide by almost nothing; there the lower-dimensional form is exact.
  constexpr double kTiny = 1e-9;
  if (n2 < kTiny) {
    volume = a / n3;
  } else if (n1 < kTiny) {
    if (a < n2) {
      volume = a * a / (2.0 * n2 * n3);
    } else if (a < n3) {
      volume = (2.0 * a - n2) / (2.0 * n3);
    } else {
      volume = (2.0 * a - n2) / (2.0 * n3) - (a - n3) * (a - n3) / (2.0 * n2 * n3);
    }
  } else {
    const double scale = 6.0 * n1 * n2 * n3;
    volume = cube(a);
    if (a > n1) volume -= cube(a - n1);
    if (a > n2) volume -= cube(a - n2);
    if (a > n3) volume -= cube(a - n3);
    if (a > n12) volume += cube(a - n12);
    volume /= scale;
  }
  volume = std::clamp(volume, 0.0, 1.0);
  return low ? volume : 1.0 - volume;
}

}  // namespace monolith
