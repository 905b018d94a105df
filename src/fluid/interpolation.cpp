#include "fluid/interpolation.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

struct AxisStencil {
  int base = 0;      // node below the position
  double t = 0.0;    // from there, in [0, 1]
};

inline AxisStencil locate(const Lattice& l, int axis, double x) {
  AxisStencil s;
  if (l.periodic[axis]) {
    x -= l.n[axis] * std::floor(x / l.n[axis]);
    x = std::clamp(x, 0.0, static_cast<double>(l.n[axis]));  // round-off of what is absurdly far away
    s.base = std::min(static_cast<int>(x), l.n[axis] - 1);
  } else {
    // With a cubic's nodes around it: the halo has two below and one beyond the last face.
    x = std::clamp(x, -0.5, static_cast<double>(l.n[axis]));
    s.base = std::min(static_cast<int>(std::floor(x)), l.n[axis] - 1);
  }
  s.t = x - s.base;
  return s;
}

// Four neighbouring nodes along x; in the field they lie at any address.
using Line = double __attribute__((vector_size(32)));
using LineInField = double __attribute__((vector_size(32), aligned(8)));

inline Line lineAt(const double* p) { return *reinterpret_cast<const LineInField*>(p); }

inline Line lesser(Line a, Line b) { return a < b ? a : b; }
inline Line greater(Line a, Line b) { return a > b ? a : b; }

inline void cubicWeights(const AxisStencil& s, double w[4]) {
  const double t = s.t;
  w[0] = -t * (t - 1.0) * (t - 2.0) / 6.0;
  w[1] = (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0;
  w[2] = -(t + 1.0) * t * (t - 2.0) / 2.0;
  w[3] = (t + 1.0) * t * (t - 1.0) / 6.0;
}

inline double linear(const Lattice& l, const double* f, double tx, double ty, double tz) {
  const auto line = [&](const double* p) { return (1.0 - tx) * p[0] + tx * p[1]; };
  const auto plane = [&](const double* p) { return (1.0 - ty) * line(p) + ty * line(p + l.stride[1]); };
  return (1.0 - tz) * plane(f) + tz * plane(f + l.stride[2]);
}

}  // namespace

double sampleLinear(const Lattice& l, const std::vector<double>& field, const Eigen::Vector3d& x) {
  const AxisStencil sx = locate(l, 0, x[0]), sy = locate(l, 1, x[1]), sz = locate(l, 2, x[2]);
  return linear(l, field.data() + l.index(sx.base, sy.base, sz.base), sx.t, sy.t, sz.t);
}

Eigen::Vector3d sampleVelocity(const Lattice& l, const std::array<std::vector<double>, 3>& velocity,
                               const Eigen::Vector3d& x) {
  // Along each axis the nodes of one component lie on the faces, those of the two others half-way between them.
  AxisStencil on[3], between[3];
  for (int a = 0; a < 3; ++a) {
    on[a] = locate(l, a, x[a]);
    between[a] = locate(l, a, x[a] - 0.5);
  }
  Eigen::Vector3d v;
  for (int a = 0; a < 3; ++a) {
    const AxisStencil& sx = a == 0 ? on[0] : between[0];
    const AxisStencil& sy = a == 1 ? on[1] : between[1];
    const AxisStencil& sz = a == 2 ? on[2] : between[2];
    v[a] = linear(l, velocity[a].data() + l.index(sx.base, sy.base, sz.base), sx.t, sy.t, sz.t);
  }
  return v;
}

double sampleCubic(const Lattice& l, const std::vector<double>& field, const Eigen::Vector3d& x, bool limited) {
  const AxisStencil sx = locate(l, 0, x[0]), sy = locate(l, 1, x[1]), sz = locate(l, 2, x[2]);
  double wx[4], wy[4], wz[4];
  cubicWeights(sx, wx);
  cubicWeights(sy, wy);
  cubicWeights(sz, wz);
  const double* f = field.data() + l.index(sx.base, sy.base, sz.base);
  // 16 lines of 4: 64 doubles, 200 flops with the limiter; bound by the loads.
  Line lines = {0.0, 0.0, 0.0, 0.0}, lows = lineAt(f - 1), highs = lows;
  const double* plane = f - 1 - l.stride[1] - l.stride[2];
  for (int k = 0; k < 4; ++k, plane += l.stride[2]) {
    Line of_plane = {0.0, 0.0, 0.0, 0.0};
    const double* p = plane;
    for (int j = 0; j < 4; ++j, p += l.stride[1]) {
      const Line line = lineAt(p);
      of_plane += wy[j] * line;
      lows = lesser(lows, line);
      highs = greater(highs, line);
    }
    lines += wz[k] * of_plane;
  }
  const double sum = (wx[0] * lines[0] + wx[1] * lines[1]) + (wx[2] * lines[2] + wx[3] * lines[3]);
  if (!limited) return sum;
  const double low = std::min(std::min(lows[0], lows[1]), std::min(lows[2], lows[3]));
  const double high = std::max(std::max(highs[0], highs[1]), std::max(highs[2], highs[3]));
  const double slack = kOvershoot * (high - low);
  return std::clamp(sum, low - slack, high + slack);
}

}  // namespace monolith
