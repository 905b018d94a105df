#include "fluid/advection.h"

#include <algorithm>
#include <cmath>

#include "fluid/interpolation.h"
#include "fluid/next_to_known.h"
#include "fluid/row_advection.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// The mirror image with the sign turned where the layer at the wall is resolved, the profile goes on straight. A layer
// far thinner than a cell would have a jump there, at which the cubic overshoots step by step: there liquid slips.
double beyondStickingWall(double first, double second) {
  return std::clamp(2.0 * first - second, -std::abs(first), std::abs(first));
}

// Beyond the walls the field mirrors what is inside, but see above.
void mirrorIntoHalo(const Lattice& l, int face_axis, bool no_slip, std::vector<double>& field) {
  for (int axis = 0; axis < 3; ++axis) {
    if (l.periodic[axis]) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    const auto s = l.stride[axis];
    const int n = l.n[axis];
    const double sign = axis == face_axis || no_slip ? -1.0 : 1.0;
    for (int q = -Lattice::kLowHalo; q < l.n[c] + Lattice::kHighHalo; ++q) {
      for (int p = -Lattice::kLowHalo; p < l.n[b] + Lattice::kHighHalo; ++p) {
        double* row = field.data() + l.index(0, 0, 0) + p * l.stride[b] + q * l.stride[c];
        if (axis == face_axis) {
          row[-s] = sign * row[s];
          row[(n + 1) * s] = sign * row[(n - 1) * s];
          row[-2 * s] = sign * row[2 * s];
        } else if (no_slip && n > 1) {
          row[-s] = beyondStickingWall(row[0], row[s]);
          row[-2 * s] = 2.0 * row[-s] - row[0];
          row[n * s] = beyondStickingWall(row[(n - 1) * s], row[(n - 2) * s]);
          row[(n + 1) * s] = 2.0 * row[n * s] - row[(n - 1) * s];
        } else {
          row[-s] = sign * row[0];
          row[n * s] = sign * row[(n - 1) * s];
          row[(n + 1) * s] = sign * row[(n - 2) * s];
          row[-2 * s] = sign * row[s];
        }
      }
    }
  }
  fillHalo(l, field);
}

// Foot of the trajectory that arrives at x with velocity v after dt (scale: dt/h), in cell widths.
inline Eigen::Vector3d traceBack(const Lattice& l, const FaceField<double>& velocity, const Eigen::Vector3d& x,
                                 const Eigen::Vector3d& v, double scale) {
  return x - scale * sampleVelocity(l, velocity, x - 0.5 * scale * v);
}

// Trilinear interpolation at nodes: means of the nearest faces.
inline Eigen::Vector3d velocityAtFace(const Lattice& l, const FaceField<double>& velocity, int axis, std::ptrdiff_t f) {
  Eigen::Vector3d v;
  const auto s = l.stride[axis];
  for (int b = 0; b < 3; ++b) {
    const double* u = velocity[b].data() + f;
    v[b] = b == axis ? u[0] : 0.25 * (u[0] + u[l.stride[b]] + u[-s] + u[l.stride[b] - s]);
  }
  return v;
}

inline Eigen::Vector3d velocityAtCell(const Lattice& l, const FaceField<double>& velocity, std::ptrdiff_t c) {
  Eigen::Vector3d v;
  for (int b = 0; b < 3; ++b) v[b] = 0.5 * (velocity[b][c] + velocity[b][c + l.stride[b]]);
  return v;
}

template <class RowFunction>
void forEachRowInTurn(int end_j, int end_k, RowFunction&& f) {
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < end_k; ++k) {
    for (int j = 0; j < end_j; ++j) f(j, k);
  }
}

// One row of `count` fields, four entries at a time where their stencils cannot leave the field: those that are wanted.
// one(i) -> its values; four(i, fours) -> whether it could.
template <std::size_t count, class Wanted, class One, class FourFunction>
void advectRow(const Lattice& l, Wanted&& wanted, One&& one, FourFunction&& four,
               const std::array<double*, count>& out) {
  constexpr int kFour = 4;
  const auto oneByOne = [&](int begin, int stop) {
    for (int i = begin; i < stop; ++i) {
      if (!wanted(i)) continue;
      const std::array<double, count> values = one(i);
      for (std::size_t n = 0; n < count; ++n) out[n][i] = values[n];
    }
  };
  if (l.n[0] < kFour) {
    oneByOne(0, l.n[0]);
    return;
  }
  for (int i = 0; i < l.n[0]; i += kFour) {
    const int first = std::min(i, l.n[0] - kFour);  // the last four overlap those before
    if (!(wanted(first) || wanted(first + 1) || wanted(first + 2) || wanted(first + 3))) continue;
    std::array<Four, count> values;
    if (!four(first, values)) {
      oneByOne(i, std::min(i + kFour, l.n[0]));
      continue;
    }
    for (int q = i - first; q < kFour; ++q) {
      if (!wanted(first + q)) continue;
      for (std::size_t n = 0; n < count; ++n) out[n][first + q] = values[n][q];
    }
  }
}

// Values of `count` fields at the known faces of an axis, as advectRow(); faces in a wall keep those of `from`, and
// beyond it there is nothing to advect.
template <std::size_t count, class One, class FourFunction>
void advectFaces(const Lattice& l, int axis, const std::vector<std::uint8_t>& known, One&& one, FourFunction&& four,
                 const std::array<const std::vector<double>*, count>& from,
                 const std::array<std::vector<double>*, count>& to) {
  for (auto* field : to) assignZero(l.size, *field);
  forEachRowInTurn(l.faceEnd(1), l.faceEnd(2), [&](int j, int k) {
    const auto row = l.index(0, j, k);
    const std::uint8_t* mask = known.data() + row;
    const int at[3] = {0, j, k};
    const auto isWall = [&](int i) {
      const int along = axis == 0 ? i : at[axis];
      return !l.periodic[axis] && (along == 0 || along == l.n[axis]);
    };
    const auto keep = [&](int i) {
      if (!mask[i]) return;
      for (std::size_t n = 0; n < count; ++n) (*to[n])[row + i] = (*from[n])[row + i];
    };
    if (axis != 0 && isWall(0)) {
      for (int i = 0; i < l.faceEnd(0); ++i) keep(i);
      return;
    }
    if (j >= l.n[1] || k >= l.n[2]) return;
    std::array<double*, count> out;
    for (std::size_t n = 0; n < count; ++n) out[n] = to[n]->data() + row;
    advectRow<count>(
        l, [&](int i) { return mask[i] != 0 && !(axis == 0 && isWall(i)); },
        [&](int i) {
          return one(std::array<int, 3>{i, j, k});
        },
        [&](int i, std::array<Four, count>& values) {
          return four(std::array<int, 3>{i, j, k}, values);
        },
        out);
    if (axis != 0) return;
    for (const int i : {0, l.n[0]}) {
      if (isWall(i)) keep(i);
    }
  });
}

}  // namespace

Eigen::Vector3d velocityAt(const Lattice& l, const FaceField<double>& velocity, const Eigen::Vector3d& position) {
  return sampleVelocity(l, velocity, position);
}

void extrapolateVelocity(const Lattice& l, int layers, bool no_slip, FaceMask& known,
                         const std::vector<FaceField<double>*>& fields) {
  // One list for each plane of faces of each axis, so that threads do not meet.
  const int planes = l.faceEnd(2);
  std::vector<std::vector<std::ptrdiff_t>> found(3 * planes);
  for (int layer = 0; layer < layers; ++layer) {
    for (int a = 0; a < 3; ++a) {
      for (FaceField<double>* field : fields) fillHalo(l, (*field)[a]);
      fillHalo(l, known[a]);
    }
    // Faces found in this layer are written, and only faces known before are read: these are marked afterwards.
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int at = 0; at < 3 * planes; ++at) {
      const int axis = at / planes;
      const std::vector<std::uint8_t>& mask = known[axis];
      found[at].clear();
      forEachNextToKnown(l, at % planes, mask.data(), [&](std::ptrdiff_t f, const std::array<int, 3>&) {
        std::array<std::ptrdiff_t, 6> near;
        int count = 0;
        for (int b = 0; b < 3; ++b) {
          for (const auto g : {f - l.stride[b], f + l.stride[b]}) {
            if (mask[g]) near[count++] = g;
          }
        }
        for (FaceField<double>* field : fields) {
          double* u = (*field)[axis].data();
          double sum = 0.0;
          for (int n = 0; n < count; ++n) sum += u[near[n]];
          u[f] = sum / count;
        }
        found[at].push_back(f);
      });
    }
    bool any = false;
#pragma omp parallel for schedule(static, kPlanesInTurn) reduction(|| : any)
    for (int at = 0; at < 3 * planes; ++at) {
      for (const auto f : found[at]) known[at / planes][f] = 1;
      any = any || !found[at].empty();
    }
    if (!any) break;
  }
  for (int a = 0; a < 3; ++a) fillHalo(l, known[a]);
  const int count = 3 * static_cast<int>(fields.size());
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < count; ++i) mirrorIntoHalo(l, i % 3, no_slip, (*fields[i / 3])[i % 3]);
}

double advectFace(const Lattice& l, const FaceField<double>& velocity, int axis, const std::array<int, 3>& face,
                  double scale) {
  const Eigen::Vector3d offset = nodeOffset(axis);
  const Eigen::Vector3d x = Eigen::Vector3d(face[0], face[1], face[2]) + offset;
  const Eigen::Vector3d v = velocityAtFace(l, velocity, axis, l.index(face[0], face[1], face[2]));
  return sampleCubic(l, velocity[axis], traceBack(l, velocity, x, v, scale) - offset, true);
}

double advectCell(const Lattice& l, const FaceField<double>& velocity, const std::vector<double>& field,
                  const std::array<int, 3>& cell, double scale) {
  const Eigen::Vector3d offset = nodeOffset(-1);
  const Eigen::Vector3d x = Eigen::Vector3d(cell[0], cell[1], cell[2]) + offset;
  const Eigen::Vector3d v = velocityAtCell(l, velocity, l.index(cell[0], cell[1], cell[2]));
  return sampleCubic(l, field, traceBack(l, velocity, x, v, scale) - offset, false);
}

void advectVelocity(const MacGrid& grid, const FaceField<double>& velocity, const FaceMask& known, double dt,
                    FaceField<double>& moved) {
  const Lattice& l = grid.lattice;
  const double scale = dt / grid.h;
  for (int a = 0; a < 3; ++a) {
    advectFaces<1>(
        l, a, known[a],
        [&](const std::array<int, 3>& face) { return std::array<double, 1>{advectFace(l, velocity, a, face, scale)}; },
        [&](const std::array<int, 3>& first, std::array<Four, 1>& values) {
          return advectFour(l, velocity, a, first, scale, values[0]);
        },
        {&velocity[a]}, {&moved[a]});
  }
}

void advectAccelerated(const MacGrid& grid, const FaceField<double>& velocity, const FaceField<double>& acceleration,
                       const FaceMask& known, double dt, FaceField<double>& moved, FaceField<double>& gained,
                       FaceField<double>& mean) {
  const Lattice& l = grid.lattice;
  for (int a = 0; a < 3; ++a) {
    mean[a].resize(l.size);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < l.size; ++i) mean[a][i] = velocity[a][i] + 0.5 * dt * acceleration[a][i];
  }
  const double scale = dt / grid.h;
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d offset = nodeOffset(a);
    advectFaces<2>(
        l, a, known[a],
        [&](const std::array<int, 3>& face) {
          const Eigen::Vector3d x = Eigen::Vector3d(face[0], face[1], face[2]) + offset;
          const Eigen::Vector3d near = x - scale * velocityAtFace(l, mean, a, l.index(face[0], face[1], face[2]));
          const Eigen::Vector3d foot = x - scale * velocityAt(l, mean, near) - offset;
          return std::array<double, 2>{sampleCubic(l, velocity[a], foot, true), sampleLinear(l, acceleration[a], foot)};
        },
        [&](const std::array<int, 3>& first, std::array<Four, 2>& values) {
          return advectFourAccelerated(l, mean, velocity[a], acceleration[a], a, first, scale, values[0], values[1]);
        },
        {&velocity[a], &acceleration[a]}, {&moved[a], &gained[a]});
  }
}

void advectCells(const MacGrid& grid, const FaceField<double>& velocity, const std::vector<double>& field, double dt,
                 double band, std::vector<double>& moved) {
  const Lattice& l = grid.lattice;
  const double scale = dt / grid.h;
  copyField(field, moved);
  forEachRowInTurn(l.n[1], l.n[2], [&](int j, int k) {
    const auto row = l.index(0, j, k);
    advectRow<1>(
        l, [&](int i) { return std::abs(field[row + i]) < band; },
        [&](int i) {
          return std::array<double, 1>{advectCell(l, velocity, field, {i, j, k}, scale)};
        },
        [&](int i, std::array<Four, 1>& values) {
          return advectFourCells(l, velocity, field, {i, j, k}, scale, values[0]);
        },
        {moved.data() + row});
  });
}

}  // namespace monolith
