// 9 + 51 + 64 + 8 loads of 32 bytes, from cache but for about one per field, and some 250 operations for four faces
// (twice that where their feet lie in different octants, and half again as many where there is something to limit):
// bound by arithmetic.
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

// Feet of the trajectories of four nodes of axis a (-1: cells) next to each other.
struct Feet {
  Four x[3];       // displacement, at most a cell
  Mask up[3];      // to the high side
  bool together;   // the same stencil for all four
};

// Weights of a cubic's nodes at a displacement x, up: to the high side.
inline void cubicWeights(Four x, Mask up, Four w[4]) {
  const Four t = up ? x : x + 1.0;
  w[0] = -t * (t - 1.0) * (t - 2.0) * (1.0 / 6.0);
  w[1] = (t + 1.0) * (t - 1.0) * (t - 2.0) * 0.5;
  w[2] = -(t + 1.0) * t * (t - 2.0) * 0.5;
  w[3] = (t + 1.0) * t * (t - 1.0) * (1.0 / 6.0);
}

// Nodes along one axis of stencils that differ: `count` of them from `first` on.
struct Nodes {
  int first = -1, count = 4;
  Four w[5];
  Mask out[5] = {};  // not in the stencil: weight zero, and no extremum

  Nodes(Four x, Mask up) {
    const Four zero = all(0.0);
    Four c[4];
    cubicWeights(x, up, c);
    if (every(up)) {
      for (int i = 0; i < 4; ++i) w[i] = c[i];
      return;
    }
    first = -2;
    count = none(up) ? 4 : 5;
    out[0] = up;
    out[4] = ~up;
    w[0] = up ? zero : c[0];
    for (int i = 1; i < 4; ++i) w[i] = up ? c[i - 1] : c[i];
    w[4] = up ? c[3] : zero;
  }
};

Four limit(Four sum, Four lowest, Four highest) {
  const Four slack = kOvershoot * (highest - lowest);
  return least(most(sum, lowest - slack), highest + slack);
}

// Extremes over n nodes along each axis. Pairs first: a comparison that waits for the one before takes longer than a
// sum.
template <int n>
inline void findRange(const double* u, const Lattice& l, Four& lowest, Four& highest) {
  lowest = highest = at(u);
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      const double* p = u + j * l.stride[1] + k * l.stride[2];
      for (int i = 0; i < n; i += 2) {
        const Four first = at(p + i), second = at(p + i + 1);
        lowest = least(lowest, least(first, second));
        highest = most(highest, most(first, second));
      }
    }
  }
}

template <bool limited>
Four cubicTogether(const double* u, const Lattice& l, const Feet& feet) {
  Four w[3][4];
  for (int d = 0; d < 3; ++d) {
    cubicWeights(feet.x[d], feet.up[d], w[d]);
    u -= (feet.up[d][0] ? 1 : 2) * l.stride[d];
  }
  Four sum = all(0.0);
  for (int k = 0; k < 4; ++k) {
    Four plane = all(0.0);
    for (int j = 0; j < 4; ++j) {
      const double* p = u + j * l.stride[1] + k * l.stride[2];
      plane += w[1][j] * ((w[0][0] * at(p) + w[0][1] * at(p + 1)) + (w[0][2] * at(p + 2) + w[0][3] * at(p + 3)));
    }
    sum += w[2][k] * plane;
  }
  if (!limited) return sum;
  // Mostly the eight nodes around the foot tell that there is nothing to limit.
  Four lowest, highest;
  findRange<2>(u + l.stride[0] + l.stride[1] + l.stride[2], l, lowest, highest);
  if (none((sum < lowest) | (sum > highest))) return sum;
  findRange<4>(u, l, lowest, highest);
  return limit(sum, lowest, highest);
}

template <bool limited>
Four cubicApart(const double* u, const Lattice& l, const Nodes& x, const Nodes& y, const Nodes& z) {
  const Four zero = all(0.0), infinite = all(std::numeric_limits<double>::infinity());
  u += x.first + y.first * l.stride[1] + z.first * l.stride[2];
  Four sum = zero, lowest = infinite, highest = -infinite;
  const auto merge = [&](Mask out, Four low, Four high, Four& to_low, Four& to_high) {
    to_low = least(to_low, out ? infinite : low);
    to_high = most(to_high, out ? -infinite : high);
  };
  for (int k = 0; k < z.count; ++k) {
    Four plane = zero, plane_low = infinite, plane_high = -infinite;
    for (int j = 0; j < y.count; ++j) {
      const double* p = u + j * l.stride[1] + k * l.stride[2];
      Four line = zero, line_low = infinite, line_high = -infinite;
      for (int i = 0; i < x.count; ++i) {
        const Four value = at(p + i);
        line += x.w[i] * value;
        if (limited) merge(x.out[i], value, value, line_low, line_high);
      }
      plane += y.w[j] * line;
      if (limited) merge(y.out[j], line_low, line_high, plane_low, plane_high);
    }
    sum += z.w[k] * plane;
    if (limited) merge(z.out[k], plane_low, plane_high, lowest, highest);
  }
  return limited ? limit(sum, lowest, highest) : sum;
}

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
    if (first[d] == 0 && !l.periodic[d]) {
      // Not below the wall, at which the first of the four is, and all of them across x.
      const std::int64_t others = d == 0 ? 0 : -1;
      const Mask lowest = {-1, others, others, others};
      feet.x[d] = lowest & (feet.x[d] < -0.5) ? all(-0.5) : feet.x[d];
    }
    feet.up[d] = feet.x[d] >= 0.0;
    feet.together = feet.together && (every(feet.up[d]) || none(feet.up[d]));
    far |= (feet.x[d] > 1.0) | (feet.x[d] < -1.0);
  }
  return none(far);
}

template <bool limited>
Four cubicAt(const double* u, const Lattice& l, const Feet& feet) {
  if (feet.together) return cubicTogether<limited>(u, l, feet);
  const auto nodes = [&](int d) { return Nodes(feet.x[d], feet.up[d]); };
  return cubicApart<limited>(u, l, nodes(0), nodes(1), nodes(2));
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
