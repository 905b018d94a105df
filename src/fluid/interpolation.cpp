#include "fluid/interpolation.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

// Part of its stencil's range by which a cubic overshoots at a smooth, resolved extremum (1/8), and a little more.
constexpr double kOvershoot = 0.15;

struct AxisStencil {
  int base = 0;      // node below the position
  double t = 0.0;    // from there, in [0, 1]
  bool cubic = false;
};

AxisStencil locate(const Lattice& l, int axis, double x) {
  AxisStencil s;
  if (l.periodic[axis]) {
    x -= l.n[axis] * std::floor(x / l.n[axis]);
    s.base = std::min(static_cast<int>(x), l.n[axis] - 1);
    s.cubic = true;
  } else {
    // The field reaches one node below and one beyond the last face.
    x = std::clamp(x, -0.5, static_cast<double>(l.n[axis]));
    s.base = std::min(static_cast<int>(std::floor(x)), l.n[axis] - 1);
    s.cubic = s.base >= 0;
  }
  s.t = x - s.base;
  return s;
}

void cubicWeights(const AxisStencil& s, double w[4]) {
  const double t = s.t;
  if (!s.cubic) {
    w[0] = w[3] = 0.0;
    w[1] = 1.0 - t;
    w[2] = t;
    return;
  }
  w[0] = -t * (t - 1.0) * (t - 2.0) / 6.0;
  w[1] = (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0;
  w[2] = -(t + 1.0) * t * (t - 2.0) / 2.0;
  w[3] = (t + 1.0) * t * (t - 1.0) / 6.0;
}

}  // namespace

double sampleLinear(const Lattice& l, const std::vector<double>& field, const Eigen::Vector3d& x) {
  const AxisStencil sx = locate(l, 0, x[0]), sy = locate(l, 1, x[1]), sz = locate(l, 2, x[2]);
  const double* f = field.data() + l.index(sx.base, sy.base, sz.base);
  const auto line = [&](const double* p) { return (1.0 - sx.t) * p[0] + sx.t * p[1]; };
  const auto plane = [&](const double* p) { return (1.0 - sy.t) * line(p) + sy.t * line(p + l.stride[1]); };
  return (1.0 - sz.t) * plane(f) + sz.t * plane(f + l.stride[2]);
}

double sampleCubic(const Lattice& l, const std::vector<double>& field, const Eigen::Vector3d& x, bool limited) {
  const AxisStencil sx = locate(l, 0, x[0]), sy = locate(l, 1, x[1]), sz = locate(l, 2, x[2]);
  double wx[4], wy[4], wz[4];
  cubicWeights(sx, wx);
  cubicWeights(sy, wy);
  cubicWeights(sz, wz);
  const double* f = field.data() + l.index(sx.base, sy.base, sz.base);
  double sum = 0.0;
  double low = f[0], high = f[0];
  for (int k = sz.cubic ? -1 : 0; k <= (sz.cubic ? 2 : 1); ++k) {
    for (int j = sy.cubic ? -1 : 0; j <= (sy.cubic ? 2 : 1); ++j) {
      const double* p = f + j * l.stride[1] + k * l.stride[2];
      double line = wx[1] * p[0] + wx[2] * p[1];
      low = std::min({low, p[0], p[1]});
      high = std::max({high, p[0], p[1]});
      if (sx.cubic) {
        line += wx[0] * p[-1] + wx[3] * p[2];
        low = std::min({low, p[-1], p[2]});
        high = std::max({high, p[-1], p[2]});
      }
      sum += wy[j + 1] * wz[k + 1] * line;
    }
  }
  if (!limited) return sum;
  const double slack = kOvershoot * (high - low);
  return std::clamp(sum, low - slack, high + slack);
}

}  // namespace monolith
