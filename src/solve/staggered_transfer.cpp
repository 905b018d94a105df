#include "solve/staggered_transfer.h"

namespace monolith {

Lattice coarsened(const Lattice& fine) {
  return Lattice({(fine.n[0] + 1) / 2, (fine.n[1] + 1) / 2, (fine.n[2] + 1) / 2}, fine.periodic);
}

bool canCoarsen(const Lattice& fine) {
  for (int a = 0; a < 3; ++a) {
    if (fine.n[a] < 4 || (fine.periodic[a] && fine.n[a] % 2 != 0)) return false;
  }
  return true;
}

template <class Real>
void restrictCells(const Lattice& fine, const std::vector<Real>& from, const Lattice& coarse, std::vector<Real>& to) {
  to.assign(coarse.size, Real(0));
  const auto sy = fine.stride[1];
  const auto sz = fine.stride[2];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < coarse.n[2]; ++k) {
    for (int j = 0; j < coarse.n[1]; ++j) {
      const Real* f = from.data() + fine.index(0, 2 * j, 2 * k);
      Real* out = to.data() + coarse.index(0, j, k);
      for (int i = 0; i < coarse.n[0]; ++i, f += 2) {
        out[i] = Real(0.125) *
                 (f[0] + f[1] + f[sy] + f[sy + 1] + f[sz] + f[sz + 1] + f[sy + sz] + f[sy + sz + 1]);
      }
    }
  }
}

template <class Real>
void restrictFaces(const Lattice& fine, int axis, const std::vector<Real>& from, const Lattice& coarse,
                   std::vector<Real>& to) {
  to.assign(coarse.size, Real(0));
  const auto sb = fine.stride[(axis + 1) % 3];
  const auto sc = fine.stride[(axis + 2) % 3];
  int end[3];
  // The last coarse face may lie beyond the fine grid, where there is nothing.
  for (int a = 0; a < 3; ++a) end[a] = a == axis ? std::min(coarse.faceEnd(a), fine.n[a] / 2 + 1) : coarse.n[a];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < end[2]; ++k) {
    for (int j = 0; j < end[1]; ++j) {
      const Real* f = from.data() + fine.index(0, 2 * j, 2 * k);
      Real* out = to.data() + coarse.index(0, j, k);
      for (int i = 0; i < end[0]; ++i, f += 2) out[i] = Real(0.25) * (f[0] + f[sb] + f[sc] + f[sb + sc]);
    }
  }
}

void restrictResidual(const Lattice& fine, int axis, const std::vector<float>& from, const Lattice& coarse,
                      std::vector<float>& to) {
  to.assign(coarse.size, 0.0f);
  const auto sa = fine.stride[axis];
  const auto sb = fine.stride[(axis + 1) % 3];
  const auto sc = fine.stride[(axis + 2) % 3];
  int end[3];
  for (int a = 0; a < 3; ++a) end[a] = a == axis ? std::min(coarse.faceEnd(a), fine.n[a] / 2 + 1) : coarse.n[a];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < end[2]; ++k) {
    for (int j = 0; j < end[1]; ++j) {
      const float* f = from.data() + fine.index(0, 2 * j, 2 * k);
      float* out = to.data() + coarse.index(0, j, k);
      for (int i = 0; i < end[0]; ++i, f += 2) {
        const float* g = f - sa;
        const float* e = f + sa;
        out[i] = 0.125f * (f[0] + f[sb] + f[sc] + f[sb + sc]) +
                 0.0625f * (g[0] + g[sb] + g[sc] + g[sb + sc] + e[0] + e[sb] + e[sc] + e[sb + sc]);
      }
    }
  }
}

void prolongateFaces(const Lattice& coarse, int axis, const std::vector<float>& from, const Lattice& fine,
                     const std::vector<float>& face_weight, std::vector<float>& to) {
  const int width = fine.faceEnd(0);
  forEachRow(fine, [&](std::ptrdiff_t row, int j, int k) {
    const int fine_index[3] = {0, j, k};
    // Coarse neighbours along y and z: the nearer one and the other, with weights.
    std::ptrdiff_t other[3] = {0, 0, 0};
    float weight[3] = {0, 0, 0};
    for (int a = 1; a < 3; ++a) {
      const bool odd = fine_index[a] & 1;
      if (a == axis) {
        other[a] = odd ? coarse.stride[a] : 0;
        weight[a] = odd ? 0.5f : 0.0f;
      } else {
        other[a] = odd ? coarse.stride[a] : -coarse.stride[a];
        weight[a] = 0.25f;
      }
    }
    const float* c = from.data() + coarse.index(0, j / 2, k / 2);
    const float* m = face_weight.data() + row;
    float* out = to.data() + row;
    const auto along = [&](const float* p, int i) {
      if (axis == 0) return (i & 1) ? 0.5f * (p[0] + p[1]) : p[0];
      return (i & 1) ? 0.75f * p[0] + 0.25f * p[1] : 0.75f * p[0] + 0.25f * p[-1];
    };
    for (int i = 0; i < width; ++i) {
      if (!(m[i] > 0.0f)) continue;
      const float* p = c + i / 2;
      const float near = (1 - weight[1]) * along(p, i) + weight[1] * along(p + other[1], i);
      const float far = weight[2] > 0.0f ? (1 - weight[1]) * along(p + other[2], i) +
                                               weight[1] * along(p + other[1] + other[2], i)
                                         : 0.0f;
      out[i] += m[i] * ((1 - weight[2]) * near + weight[2] * far);
    }
  });
}

void prolongateCells(const Lattice& coarse, const std::vector<float>& from, const Lattice& fine,
                     const std::vector<float>& mask, std::vector<float>& to) {
  forEachRow(fine, [&](std::ptrdiff_t row, int j, int k) {
    const auto sy = (j & 1) ? coarse.stride[1] : -coarse.stride[1];
    const auto sz = (k & 1) ? coarse.stride[2] : -coarse.stride[2];
    const float* c = from.data() + coarse.index(0, j / 2, k / 2);
    const float* has = mask.data() + row;
    float* out = to.data() + row;
    for (int i = 0; i < fine.n[0]; ++i) {
      if (!(has[i] > 0.0f)) continue;
      const float* p = c + i / 2;
      const int sx = (i & 1) ? 1 : -1;
      const auto line = [&](const float* q) { return 0.75f * q[0] + 0.25f * q[sx]; };
      out[i] += 0.75f * (0.75f * line(p) + 0.25f * line(p + sy)) + 0.25f * (0.75f * line(p + sz) + 0.25f * line(p + sy + sz));
    }
  });
}

#define MONOLITH_INSTANTIATE(Real)                                                                                \
  template void restrictCells(const Lattice&, const std::vector<Real>&, const Lattice&, std::vector<Real>&);       \
  template void restrictFaces(const Lattice&, int, const std::vector<Real>&, const Lattice&, std::vector<Real>&);
MONOLITH_INSTANTIATE(double)
MONOLITH_INSTANTIATE(float)
#undef MONOLITH_INSTANTIATE

}  // namespace monolith
