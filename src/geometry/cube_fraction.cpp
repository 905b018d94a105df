#include "geometry/cube_fraction.h"

#include <algorithm>
#include <array>

namespace monolith {

double insideFraction(double distance, const Eigen::Vector3d& gradient, double width) {
  const Eigen::Vector3d slope = gradient.cwiseAbs();
  const double total = slope.sum();
  if (!(total > 0.0)) return distance < 0.0 ? 1.0 : 0.0;
  // The plane n . x = alpha in the unit cube with n >= 0, sum n = 1; the solid is below it.
  const double scale = 1.0 / total;
  const double alpha = 0.5 - distance * gradient.norm() * scale / width;
  if (alpha <= 0.0) return 0.0;
  if (alpha >= 1.0) return 1.0;
  std::array<double, 3> n = {slope[0] * scale, slope[1] * scale, slope[2] * scale};
  const auto order = [&](int i, int j) {
    const double less = std::min(n[i], n[j]);
    n[j] = std::max(n[i], n[j]);
    n[i] = less;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  const bool low = alpha <= 0.5;
  const double a = low ? alpha : 1.0 - alpha;
  const double n1 = n[0], n2 = n[1], n3 = n[2], n12 = n1 + n2;
  double volume = 0.0;
  // Where the plane is nearly parallel to faces of the cube the forms that divide by n1 n2 would lose every digit; they
  // are used only where their terms are as small as the divisor, and n1 of almost nothing is none.
  constexpr double kTiny = 1e-9;
  if (a >= n12 && n12 <= n3) {
    volume = (2.0 * a - n12) / (2.0 * n3);
  } else if (n1 < kTiny) {
    // One of the two sides of the trapezoid, less what lies beyond the cube.
    const double beyond = std::max(a - n3, 0.0);
    volume = a < n2 ? a * a / (2.0 * n2 * n3) : (2.0 * a - n2) / (2.0 * n3) - beyond * beyond / (2.0 * n2 * n3);
  } else if (a < n1) {
    volume = a * a * a / (6.0 * n1 * n2 * n3);
  } else if (a < n2) {
    volume = (a * (a - n1) + n1 * n1 / 3.0) / (2.0 * n2 * n3);
  } else {
    const auto less = [&](double m) { return m * m * (m - 3.0 * a); };
    const double sum = a < n3 ? a * a * (3.0 * n12 - a) : a * a * (3.0 - 2.0 * a) + less(n3);
    volume = (sum + less(n1) + less(n2)) / (6.0 * n1 * n2 * n3);
  }
  volume = std::clamp(volume, 0.0, 1.0);
  return low ? volume : 1.0 - volume;
}

}  // namespace monolith
