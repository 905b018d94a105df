#include "fluid/advection.h"

#include <algorithm>
#include <cmath>

#include "fluid/interpolation.h"

namespace monolith {
namespace {

// The mirror image with the sign turned where the layer at the wall is resolved, the profile goes on straight. A layer far
// thinner than a cell would have a jump there, at which the cubic overshoots step by step: there liquid slips.
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
        } else if (no_slip && n > 1) {
          row[-s] = beyondStickingWall(row[0], row[s]);
          row[n * s] = beyondStickingWall(row[(n - 1) * s], row[(n - 2) * s]);
          row[(n + 1) * s] = 2.0 * row[n * s] - row[(n - 1) * s];
        } else {
          row[-s] = sign * row[0];
          row[n * s] = sign * row[(n - 1) * s];
          row[(n + 1) * s] = sign * row[(n - 2) * s];
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

}  // namespace

Eigen::Vector3d velocityAt(const Lattice& l, const FaceField<double>& velocity, const Eigen::Vector3d& position) {
  return sampleVelocity(l, velocity, position);
}

void extrapolateVelocity(const Lattice& l, int layers, bool no_slip, std::array<std::vector<std::uint8_t>, 3>& known,
                         FaceField<double>& velocity) {
  // One list of unknown faces for each plane of faces, so that threads do not meet.
  std::vector<std::vector<std::ptrdiff_t>> missing(l.faceEnd(2)), found(l.faceEnd(2));
  for (int a = 0; a < 3; ++a) {
    std::vector<double>& u = velocity[a];
    std::vector<std::uint8_t>& mask = known[a];
    const int planes = l.faceEnd(2);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < planes; ++k) {
      missing[k].clear();
      for (int j = 0; j < l.faceEnd(1); ++j) {
        const auto row = l.index(0, j, k);
        for (auto f = row; f < row + l.faceEnd(0); ++f) {
          if (!mask[f]) missing[k].push_back(f);
        }
      }
    }
    for (int layer = 0; layer < layers; ++layer) {
      fillHalo(l, u);
      fillHalo(l, mask);
      // Faces found in this layer are written, and only faces known before are read: these are marked afterwards.
#pragma omp parallel for schedule(static)
      for (int k = 0; k < planes; ++k) {
        found[k].clear();
        std::size_t left = 0;
        for (const auto f : missing[k]) {
          double sum = 0.0;
          int count = 0;
          for (int b = 0; b < 3; ++b) {
            for (const auto g : {f - l.stride[b], f + l.stride[b]}) {
              if (!mask[g]) continue;
              sum += u[g];
              ++count;
            }
          }
          if (count == 0) {
            missing[k][left++] = f;
            continue;
          }
          u[f] = sum / count;
          found[k].push_back(f);
        }
        missing[k].resize(left);
      }
      bool any = false;
      for (int k = 0; k < planes; ++k) {
        for (const auto f : found[k]) mask[f] = 1;
        any = any || !found[k].empty();
      }
      if (!any) break;
    }
    fillHalo(l, mask);
    mirrorIntoHalo(l, a, no_slip, u);
  }
}

void advectVelocity(const MacGrid& grid, const FaceField<double>& velocity,
                    const std::array<std::vector<std::uint8_t>, 3>& known, double dt, FaceField<double>& moved) {
  const Lattice& l = grid.lattice;
  const double scale = dt / grid.h;
  for (int a = 0; a < 3; ++a) {
    moved[a].assign(l.size, 0.0);
    const Eigen::Vector3d offset = nodeOffset(a);
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        if (!known[a][row + i]) continue;
        const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + offset;
        const Eigen::Vector3d v = velocityAtFace(l, velocity, a, row + i);
        const Eigen::Vector3d foot = traceBack(l, velocity, x, v, scale);
        moved[a][row + i] = sampleCubic(l, velocity[a], foot - offset, true);
      }
    });
  }
}

void advectAccelerated(const MacGrid& grid, const FaceField<double>& velocity, const FaceField<double>& acceleration,
                       const std::array<std::vector<std::uint8_t>, 3>& known, double dt, FaceField<double>& moved,
                       FaceField<double>& gained) {
  const Lattice& l = grid.lattice;
  FaceField<double> mean = velocity;
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < l.size; ++i) mean[a][i] += 0.5 * dt * acceleration[a][i];
  }
  const double scale = dt / grid.h;
  for (int a = 0; a < 3; ++a) {
    moved[a].assign(l.size, 0.0);
    gained[a].assign(l.size, 0.0);
    const Eigen::Vector3d offset = nodeOffset(a);
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        if (!known[a][row + i]) continue;
        const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + offset;
        const Eigen::Vector3d near = x - scale * velocityAtFace(l, mean, a, row + i);
        const Eigen::Vector3d node = x - scale * velocityAt(l, mean, near) - offset;
        moved[a][row + i] = sampleCubic(l, velocity[a], node, true);
        gained[a][row + i] = sampleLinear(l, acceleration[a], node);
      }
    });
  }
}

void advectCells(const MacGrid& grid, const FaceField<double>& velocity, const std::vector<double>& field, double dt,
                 std::vector<double>& moved, double band) {
  const Lattice& l = grid.lattice;
  const double scale = dt / grid.h;
  moved = field;
  const Eigen::Vector3d offset = nodeOffset(-1);
#pragma omp parallel for schedule(static)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (std::abs(field[c]) > band) continue;
        const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + offset;
        const Eigen::Vector3d v = velocityAtCell(l, velocity, c);
        const Eigen::Vector3d foot = traceBack(l, velocity, x, v, scale);
        moved[c] = sampleCubic(l, field, foot - offset, false);
      }
    }
  }
}

}  // namespace monolith
