#include "geometry/cube_fraction.h"

#include <algorithm>
#include <cmath>

namespace monolith {

namespace {

// Where the plane is nearly parallel to faces of the cube the forms that divide by n1 n2 would lose every digit; they
// are used only where their terms are as small as the divisor, and n1 of almost nothing is none.
constexpr double kTiny = 1e-9;

inline void order(double& less, double& more) {
  const double least = std::min(less, more);
  more = std::max(less, more);
  less = least;
}

// Every case is one quotient, but for a corner of one: without branches, for the vector units.
inline double fractionInside(double distance, double gx, double gy, double gz, double length, double width) {
  double n1 = std::abs(gx), n2 = std::abs(gy), n3 = std::abs(gz);
  const double total = n1 + n2 + n3;
  // The plane n . x = alpha in the unit cube with n >= 0, sum n = 1; the solid is below it.
  const double scale = 1.0 / total;
  const double alpha = 0.5 - distance * length * scale / width;
  n1 *= scale;
  n2 *= scale;
  n3 *= scale;
  order(n1, n2);
  order(n2, n3);
  order(n1, n2);
  const bool low = alpha <= 0.5;
  const double a = low ? alpha : 1.0 - alpha, n12 = n1 + n2;
  const double prism = 2.0 * n3, wedge = 2.0 * n2 * n3, corner = 6.0 * n1 * n2 * n3;
  const bool is_prism = (a >= n12) & (n12 <= n3), is_flat = n1 < kTiny;
  const double triple = a + a + a;  // a sum, not to be fused with what it is taken from here and not there
  const auto less = [triple](double m) { return m * m * (m - triple); };
  const double sum = a < n3 ? a * a * (3.0 * n12 - a) : a * a * (3.0 - 2.0 * a) + less(n3);
  double above = sum + less(n1) + less(n2), below = corner;
  above = a < n2 ? a * (a - n1) + n1 * n1 / 3.0 : above;
  below = a < n2 ? wedge : below;
  above = a < n1 ? a * a * a : above;
  below = a < n1 ? corner : below;
  // One of the two sides of the trapezoid, less what lies beyond the cube.
  above = is_flat ? (a < n2 ? a * a : 2.0 * a - n2) : above;
  below = is_flat ? (a < n2 ? wedge : prism) : below;
  above = is_prism ? 2.0 * a - n12 : above;
  below = is_prism ? prism : below;
  const double beyond = std::max(a - n3, 0.0);
  const double cut_off = !is_prism & is_flat & !(a < n2) ? beyond * beyond / wedge : 0.0;
  const double volume = std::min(std::max(above / below - cut_off, 0.0), 1.0);
  const double part = low ? volume : 1.0 - volume;
  const double inside = alpha <= 0.0 ? 0.0 : alpha >= 1.0 ? 1.0 : part;
  return total > 0.0 ? inside : distance < 0.0 ? 1.0 : 0.0;
}

}  // namespace

double insideFraction(double distance, const Eigen::Vector3d& gradient, double width) {
  return fractionInside(distance, gradient[0], gradient[1], gradient[2], gradient.norm(), width);
}

void insideFractions(CutCubes& cubes, double width) {
  const double *distance = cubes.distance.data(), *gx = cubes.gradient[0].data(), *gy = cubes.gradient[1].data(),
               *gz = cubes.gradient[2].data(), *length = cubes.length.data();
  double* inside = cubes.inside.data();
#pragma omp simd
  for (int i = 0; i < CutCubes::kCount; ++i) {
    inside[i] = fractionInside(distance[i], gx[i], gy[i], gz[i], length[i], width);
  }
}

}  // namespace monolith
