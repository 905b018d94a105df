// 9 + 51 + 64 loads of 32 bytes, from cache but for about one per field, and some 350 operations for four faces (twice
// that where their feet lie in different octants): bound by arithmetic.
#include "fluid/row_advection.h"

#include <limits>

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
inline LinearWeights fromHalfWay(int first, Four x) { return {first, 2, {all(0.5) - x, all(0.5) + x, all(0.0)}}; }

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

// Component b at nodes of axis a (-1: cells) displaced by x, each |x| <= 1/2: along a, b's nodes lie half-way from the
// node below; along b likewise, to the one above.
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

// Cubic at the foot, displaced by x; up: to the high side of an axis. With n = 4 all four are on the same side of each
// axis; with n = 5 each has its own, and a node that is not in its stencil counts with weight zero and as no extremum.
template <int n, bool limited>
Four cubic(const double* u, const Lattice& l, const Four x[3], const Mask up[3]) {
  const Four zero = all(0.0), infinite = all(std::numeric_limits<double>::infinity());
  Four w[3][n];
  for (int d = 0; d < 3; ++d) {
    const Four t = up[d] ? x[d] : x[d] + 1.0;
    const Four c[4] = {-t * (t - 1.0) * (t - 2.0) * (1.0 / 6.0), (t + 1.0) * (t - 1.0) * (t - 2.0) * 0.5,
                       -(t + 1.0) * t * (t - 2.0) * 0.5, (t + 1.0) * t * (t - 1.0) * (1.0 / 6.0)};
    if (n == 4) {
      for (int q = 0; q < 4; ++q) w[d][q] = c[q];
      u -= (up[d][0] ? 1 : 2) * l.stride[d];
    } else {
      w[d][0] = up[d] ? zero : c[0];
      for (int q = 1; q < 4; ++q) w[d][q] = up[d] ? c[q - 1] : c[q];
      w[d][n - 1] = up[d] ? c[3] : zero;
      u -= 2 * l.stride[d];
    }
  }
  Four sum = zero, lowest = infinite, highest = -infinite;
  // Leaves out what the n-th node along an axis found where it is not in the stencil.
  const auto merge = [&](int d, int q, Four low, Four high, Four& to_low, Four& to_high) {
    if (n == 5 && (q == 0 || q == n - 1)) {
      const Mask out = q == 0 ? up[d] : ~up[d];
      low = out ? infinite : low;
      high = out ? -infinite : high;
    }
    to_low = least(to_low, low);
    to_high = most(to_high, high);
  };
  for (int k = 0; k < n; ++k) {
    Four plane = zero, plane_low = infinite, plane_high = -infinite;
    for (int j = 0; j < n; ++j) {
      const double* p = u + j * l.stride[1] + k * l.stride[2];
      Four line = zero, line_low = infinite, line_high = -infinite;
      for (int i = 0; i < n; ++i) {
        const Four value = at(p + i);
        line += w[0][i] * value;
        if (limited) merge(0, i, value, value, line_low, line_high);
      }
      plane += w[1][j] * line;
      if (limited) merge(1, j, line_low, line_high, plane_low, plane_high);
    }
    sum += w[2][k] * plane;
    if (limited) merge(2, k, plane_low, plane_high, lowest, highest);
  }
  if (!limited) return sum;
  const Four slack = kOvershoot * (highest - lowest);
  return least(most(sum, lowest - slack), highest + slack);
}

// Feet of the trajectories of four nodes of axis a (-1: cells) next to each other.
struct Feet {
  Four x[3];      // displacement, at most a cell
  Mask up[3];     // to the high side
  bool together;  // all in the same octant
};

// With the velocity at `part` of the way back. False as advectFour().
template <int a>
bool findFeet(const Lattice& l, const FaceField<double>& velocity, const std::array<int, 3>& first, double part,
              double scale, Feet& feet) {
  const auto f = l.index(first[0], first[1], first[2]);
  const double* u[3] = {velocity[0].data() + f, velocity[1].data() + f, velocity[2].data() + f};
  Four x[3];
  Mask far = {0, 0, 0, 0};
  for (int b = 0; b < 3; ++b) {
    const auto sb = l.stride[b];
    Four v = at(u[b]);
    if (a < 0) {
      v = 0.5 * (v + at(u[b] + sb));
    } else if (b != a) {
      const auto sa = l.stride[a < 0 ? 0 : a];
      v = 0.25 * (v + at(u[b] + sb) + at(u[b] - sa) + at(u[b] + sb - sa));
    }
    x[b] = -part * scale * v;
    far |= (x[b] > 0.5) | (x[b] < -0.5);
  }
  if (any(far)) return false;
  feet.x[0] = -scale * component<a, 0>(u[0], l, x);
  feet.x[1] = -scale * component<a, 1>(u[1], l, x);
  feet.x[2] = -scale * component<a, 2>(u[2], l, x);
  feet.together = true;
  for (int d = 0; d < 3; ++d) {
    feet.up[d] = feet.x[d] >= 0.0;
    feet.together = feet.together && (every(feet.up[d]) || none(feet.up[d]));
    // There is one node below the first.
    if (first[d] == 0 && !every(feet.up[d])) return false;
    far |= (feet.x[d] > 1.0) | (feet.x[d] < -1.0);
  }
  if (any(far)) return false;
  const bool lowest = first[0] == 0 || first[1] == 0 || first[2] == 0;
  return !lowest || feet.together;
}

template <bool limited>
Four cubicAt(const double* field, const Lattice& l, const Feet& feet) {
  return feet.together ? cubic<4, limited>(field, l, feet.x, feet.up) : cubic<5, limited>(field, l, feet.x, feet.up);
}

template <int a>
bool advect(const Lattice& l, const FaceField<double>& velocity, const double* field, const std::array<int, 3>& first,
            double scale, Four& moved) {
  Feet feet;
  if (!findFeet<a>(l, velocity, first, 0.5, scale, feet)) return false;
  moved = cubicAt<(a >= 0)>(field + l.index(first[0], first[1], first[2]), l, feet);
  return true;
}

template <int a>
bool advectAccelerated(const Lattice& l, const FaceField<double>& mean, const double* u, const double* acceleration,
                       const std::array<int, 3>& first, double scale, Four& moved, Four& gained) {
  Feet feet;
  if (!findFeet<a>(l, mean, first, 1.0, scale, feet)) return false;
  const auto f = l.index(first[0], first[1], first[2]);
  moved = cubicAt<true>(u + f, l, feet);
  gained = interpolate<3, 3, 3>(acceleration + f, l, fromNode(feet.x[0]), fromNode(feet.x[1]), fromNode(feet.x[2]));
  return true;
}

}  // namespace

bool advectFour(const Lattice& l, const FaceField<double>& velocity, int axis, const std::array<int, 3>& first,
                double scale, Four& moved) {
  switch (axis) {
    case 0:
      return advect<0>(l, velocity, velocity[0].data(), first, scale, moved);
    case 1:
      return advect<1>(l, velocity, velocity[1].data(), first, scale, moved);
    default:
      return advect<2>(l, velocity, velocity[2].data(), first, scale, moved);
  }
}

bool advectFourAccelerated(const Lattice& l, const FaceField<double>& mean, const std::vector<double>& u,
                           const std::vector<double>& acceleration, int axis, const std::array<int, 3>& first,
                           double scale, Four& moved, Four& gained) {
  switch (axis) {
    case 0:
      return advectAccelerated<0>(l, mean, u.data(), acceleration.data(), first, scale, moved, gained);
    case 1:
      return advectAccelerated<1>(l, mean, u.data(), acceleration.data(), first, scale, moved, gained);
    default:
      return advectAccelerated<2>(l, mean, u.data(), acceleration.data(), first, scale, moved, gained);
  }
}

bool advectFourCells(const Lattice& l, const FaceField<double>& velocity, const std::vector<double>& field,
                     const std::array<int, 3>& first, double scale, Four& moved) {
  return advect<-1>(l, velocity, field.data(), first, scale, moved);
}

}  // namespace monolith
