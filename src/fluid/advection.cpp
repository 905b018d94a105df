#include "fluid/advection.h"

#include "fluid/interpolation.h"

namespace monolith {
namespace {

// Beyond the walls the field mirrors what is inside, with the sign given.
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

// Foot of the trajectory that arrives at x after dt, in cell widths.
Eigen::Vector3d traceBack(const MacGrid& grid, const FaceField<double>& velocity, const Eigen::Vector3d& x, double dt) {
  const double scale = dt / grid.h;
  const Eigen::Vector3d half = x - 0.5 * scale * velocityAt(grid.lattice, velocity, x);
  return x - scale * velocityAt(grid.lattice, velocity, half);
}

}  // namespace

Eigen::Vector3d velocityAt(const Lattice& l, const FaceField<double>& velocity, const Eigen::Vector3d& position) {
  Eigen::Vector3d v;
  for (int a = 0; a < 3; ++a) v[a] = sampleLinear(l, velocity[a], position - nodeOffset(a));
  return v;
}

void extrapolateVelocity(const Lattice& l, int layers, bool no_slip, std::array<std::vector<std::uint8_t>, 3>& known,
                         FaceField<double>& velocity) {
  for (int a = 0; a < 3; ++a) {
    std::vector<double>& u = velocity[a];
    std::vector<std::uint8_t>& mask = known[a];
    for (int layer = 0; layer < layers; ++layer) {
      fillHalo(l, u);
      fillHalo(l, mask);
      const std::vector<std::uint8_t> before = mask;
      // Faces found in this layer are written, and only faces known before are read.
      forEachRow(l, [&](std::ptrdiff_t row, int, int) {
        for (auto f = row; f < row + l.faceEnd(0); ++f) {
          if (before[f]) continue;
          double sum = 0.0;
          int count = 0;
          for (int b = 0; b < 3; ++b) {
            for (const auto g : {f - l.stride[b], f + l.stride[b]}) {
              if (!before[g]) continue;
              sum += u[g];
              ++count;
            }
          }
          if (count == 0) continue;
          u[f] = sum / count;
          mask[f] = 1;
        }
      });
    }
    fillHalo(l, mask);
    mirrorIntoHalo(l, a, no_slip, u);
  }
}

void advectVelocity(const MacGrid& grid, const FaceField<double>& velocity,
                    const std::array<std::vector<std::uint8_t>, 3>& known, double dt, FaceField<double>& moved) {
  const Lattice& l = grid.lattice;
  for (int a = 0; a < 3; ++a) {
    moved[a].assign(l.size, 0.0);
    const Eigen::Vector3d offset = nodeOffset(a);
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        if (!known[a][row + i]) continue;
        const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + offset;
        const Eigen::Vector3d foot = traceBack(grid, velocity, x, dt);
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
        const Eigen::Vector3d near = x - scale * velocityAt(l, mean, x);
        const Eigen::Vector3d node = x - scale * velocityAt(l, mean, near) - offset;
        moved[a][row + i] = sampleCubic(l, velocity[a], node, true);
        gained[a][row + i] = sampleLinear(l, acceleration[a], node);
      }
    });
  }
}

void advectCells(const MacGrid& grid, const FaceField<double>& velocity, const std::vector<double>& field, double dt,
                 std::vector<double>& moved) {
  const Lattice& l = grid.lattice;
  moved = field;
  const Eigen::Vector3d offset = nodeOffset(-1);
#pragma omp parallel for schedule(static)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const Eigen::Vector3d x = Eigen::Vector3d(i, j, k) + offset;
        const Eigen::Vector3d foot = traceBack(grid, velocity, x, dt);
        moved[l.index(i, j, k)] = sampleCubic(l, field, foot - offset, false);
      }
    }
  }
}

}  // namespace monolith
