// 9 + 51 + 64 loads of 32 bytes, from cache but for about one per field, and some 350 operations for four faces: bound by
// arithmetic.
#include "fluid/row_advection.h"

#include "fluid/interpolation.h"

namespace monolith {
namespace {

using Mask = std::int64_t __attribute__((vector_size(32)));
using FourInField = double __attribute__((vector_size(32), aligned(8)));

inline Four at(const double* p) { return *reinterpret_cast<const FourInField*>(p); }
inline Four all(double x) { return Four{x, x, x, x}; }
inline Four least(Four a, Four b) { return a < b ? a : b; }
inline Four most(Four a, Four b) { return a > b ? a : b; }
inline bool any(Mask m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }
inline bool none(Mask m) { return !any(m); }
inline bool every(Mask m) { return (m[0] & m[1] & m[2] & m[3]) != 0; }

// Weights of the nodes from `first` on at a displacement x from the node in the middle or half-way between two.
struct LinearWeights {
  int first, count;
  Four w[3];
};

inline LinearWeights fromNode(Four x) {
  const Four zero = all(0.0);
  const Four up = most(x, zero), down = most(-x, zero);
  return {-1, 3, {down, all(1.0) - up - down, up}};
}
inline LinearWeights fromHalfWay(int first, Four x) {
  return {first, 2, {all(0.5) - x, all(0.5) + x, all(0.0)}};
}

template <int count_x, int count_y, int count_z>
inline Four interpolate(const double* u, const Lattice& l, const LinearWeights& x, const LinearWeights& y,
                        const LinearWeights& z) {
  const double* first = u + x.first + y.first * l.stride[1] + z.first * l.stride[2];
  Four sum = all(0.0);
  for (int k = 0; k < count_z; ++k) {
    Four plane = all(0.0);
    for (int j = 0; j < count_y; ++j) {
      const double* p = first + j * l.stride[1] + k * l.stride[2];
      Four line = all(0.0);
      for (int i = 0; i < count_x; ++i) line += x.w[i] * at(p + i);
      plane += y.w[j] * line;
    }
    sum += z.w[k] * plane;
  }
  return sum;
}

// Component b at faces of axis a displaced by x, each |x| <= 1/2: along a, where b's nodes lie half-way, from the node
// below; along b likewise, up to the one above.
template <int a, int b>
inline Four component(const double* u, const Lattice& l, const Four x[3]) {
  LinearWeights w[3];
  for (int d = 0; d < 3; ++d) {
    if (a != b && d == a) {
      w[d] = fromHalfWay(-1, x[d]);
    } else if (a != b && d == b) {
      w[d] = fromHalfWay(0, x[d]);
    } else {
      w[d] = fromNode(x[d]);
    }
  }
  constexpr auto count = [](int d) { return a != b && (d == a || d == b) ? 2 : 3; };
  return interpolate<count(0), count(1), count(2)>(u, l, w[0], w[1], w[2]);
}

// Cubic at the foot, displaced by x into one octant: the low side of an axis if `low`. Limited as sampleCubic().
Four cubic(const double* u, const Lattice& l, const Four x[3], const bool low[3]) {
  Four w[3][4];
  for (int d = 0; d < 3; ++d) {
    const Four t = low[d] ? x[d] + 1.0 : x[d];
    w[d][0] = -t * (t - 1.0) * (t - 2.0) * (1.0 / 6.0);
    w[d][1] = (t + 1.0) * (t - 1.0) * (t - 2.0) * 0.5;
    w[d][2] = -(t + 1.0) * t * (t - 2.0) * 0.5;
    w[d][3] = (t + 1.0) * t * (t - 1.0) * (1.0 / 6.0);
    u -= (low[d] ? 2 : 1) * l.stride[d];
  }
  Four sum = all(0.0), lowest = at(u), highest = lowest;
  for (int k = 0; k < 4; ++k) {
    Four plane = all(0.0);
    for (int j = 0; j < 4; ++j) {
      const double* p = u + j * l.stride[1] + k * l.stride[2];
      Four line = all(0.0);
      for (int i = 0; i < 4; ++i) {
        const Four value = at(p + i);
        line += w[0][i] * value;
        lowest = least(lowest, value);
        highest = most(highest, value);
      }
      plane += w[1][j] * line;
    }
    sum += w[2][k] * plane;
  }
  const Four slack = kOvershoot * (highest - lowest);
  return least(most(sum, lowest - slack), highest + slack);
}

template <int a>
bool advect(const Lattice& l, const FaceField<double>& velocity, std::ptrdiff_t f, double scale, Four& moved) {
  const double* u[3] = {velocity[0].data() + f, velocity[1].data() + f, velocity[2].data() + f};
  Four x[3];
  Mask far = {0, 0, 0, 0};
  for (int b = 0; b < 3; ++b) {
    const auto sa = l.stride[a], sb = l.stride[b];
    Four v = at(u[b]);
    if (b != a) v = 0.25 * (v + at(u[b] + sb) + at(u[b] - sa) + at(u[b] + sb - sa));
    x[b] = -0.5 * scale * v;
    far |= (x[b] > 0.5) | (x[b] < -0.5);
  }
  if (any(far)) return false;
  const Four foot[3] = {-scale * component<a, 0>(u[0], l, x), -scale * component<a, 1>(u[1], l, x),
                        -scale * component<a, 2>(u[2], l, x)};
  bool low[3];
  for (int d = 0; d < 3; ++d) {
    const Mask below = foot[d] < 0.0;
    low[d] = every(below);
    if (!low[d] && !none(below)) return false;
    far |= (foot[d] > 1.0) | (foot[d] < -1.0);
  }
  if (any(far)) return false;
  moved = cubic(u[a], l, foot, low);
  return true;
}

}  // namespace

bool advectFour(const Lattice& l, const FaceField<double>& velocity, int axis, std::ptrdiff_t face, double scale,
                Four& moved) {
  switch (axis) {
    case 0: return advect<0>(l, velocity, face, scale, moved);
    case 1: return advect<1>(l, velocity, face, scale, moved);
    default: return advect<2>(l, velocity, face, scale, moved);
  }
}

}  // namespace monolith
