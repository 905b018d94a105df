#include "solve/staggered_transfer.h"

#include <algorithm>

#include "solve/kernel_work.h"

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
#pragma omp parallel for schedule(static, kPlanesInTurn) if (fine.size >= kSizeWorthSharing)
  for (int k = 0; k < coarse.n[2]; ++k) {
    for (int j = 0; j < coarse.n[1]; ++j) {
      const Real* f = from.data() + fine.index(0, 2 * j, 2 * k);
      Real* out = to.data() + coarse.index(0, j, k);
      for (int i = 0; i < coarse.n[0]; ++i, f += 2) {
        out[i] = Real(0.125) * (f[0] + f[1] + f[sy] + f[sy + 1] + f[sz] + f[sz + 1] + f[sy + sz] + f[sy + sz + 1]);
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
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < end[2]; ++k) {
    for (int j = 0; j < end[1]; ++j) {
      const Real* f = from.data() + fine.index(0, 2 * j, 2 * k);
      Real* out = to.data() + coarse.index(0, j, k);
      for (int i = 0; i < end[0]; ++i, f += 2) out[i] = Real(0.25) * (f[0] + f[sb] + f[sc] + f[sb + sc]);
    }
  }
}

// Fine rows are summed first, contiguously, then along x: for each coarse face eight fine ones are streamed, 10 or 15
// flops.
void restrictResidual(const Lattice& fine, int axis, const float* from, const Lattice& coarse, const Planes& planes,
                      float* to) {
  const auto sy = fine.stride[1];
  const auto sz = fine.stride[2];
  int end[3];
  // The last coarse face may lie beyond the fine grid, where there is nothing.
  for (int a = 0; a < 3; ++a) end[a] = a == axis ? std::min(coarse.faceEnd(a), fine.n[a] / 2 + 1) : coarse.n[a];
  end[2] = std::min(end[2], planes.end);
  countWork(static_cast<std::size_t>(end[0]) * end[1] * std::max(0, end[2] - planes.first), axis == 0 ? 10.0 : 15.0,
            9.0 * sizeof(float));
#pragma omp parallel for schedule(static) if (fine.size >= kSizeWorthSharing)
  for (int k = planes.first; k < end[2]; ++k) {
    std::vector<float> sums(2 * end[0] + 2);
    float* sum = sums.data() + 1;
    const int width = 2 * end[0];
    for (int j = 0; j < end[1]; ++j) {
      const float* f = from + fine.index(0, 2 * j, 2 * k);
      float* out = to + coarse.index(0, j, k);
      if (axis == 0) {
#pragma omp simd
        for (int i = -1; i < width; ++i) sum[i] = f[i] + f[i + sy] + f[i + sz] + f[i + sy + sz];
#pragma omp simd
        for (int i = 0; i < end[0]; ++i) {
          out[i] = 0.125f * sum[2 * i] + 0.0625f * (sum[2 * i - 1] + sum[2 * i + 1]);
        }
      } else {
        const auto along = axis == 1 ? sy : sz, across = axis == 1 ? sz : sy;
#pragma omp simd
        for (int i = 0; i < width; ++i) {
          const float* g = f + i;
          sum[i] =
              0.125f * (g[0] + g[across]) + 0.0625f * (g[-along] + g[across - along] + g[along] + g[across + along]);
        }
#pragma omp simd
        for (int i = 0; i < end[0]; ++i) out[i] = sum[2 * i] + sum[2 * i + 1];
      }
    }
  }
}

void restrictResidual(const Lattice& fine, const float* from, const Lattice& coarse, const Planes& planes, float factor,
                      float* to) {
  const auto sy = fine.stride[1];
  const auto sz = fine.stride[2];
  const int width = 2 * coarse.n[0];
  const int end = std::min(coarse.n[2], planes.end);
  countWork(static_cast<std::size_t>(coarse.n[0]) * coarse.n[1] * std::max(0, end - planes.first), 8.0,
            9.0 * sizeof(float));
#pragma omp parallel for schedule(static) if (fine.size >= kSizeWorthSharing)
  for (int k = planes.first; k < end; ++k) {
    std::vector<float> sum(width);
    for (int j = 0; j < coarse.n[1]; ++j) {
      const float* f = from + fine.index(0, 2 * j, 2 * k);
      float* out = to + coarse.index(0, j, k);
#pragma omp simd
      for (int i = 0; i < width; ++i) sum[i] = f[i] + f[i + sy] + f[i + sz] + f[i + sy + sz];
#pragma omp simd
      for (int i = 0; i < coarse.n[0]; ++i) out[i] = 0.125f * factor * (sum[2 * i] + sum[2 * i + 1]);
    }
  }
}

namespace {

// Coarse row interpolated to the y and z of a fine row: the nearer one and the other along each axis, with weights.
// `faces`: axis along which both lie on the same planes, or -1.
class CoarseRow {
 public:
  CoarseRow(const Lattice& coarse, int faces) : coarse_(coarse), faces_(faces), values_(coarse.n[0] + 3) {}

  // Entries -1 to n + 1.
  const float* at(const float* from, int j, int k) {
    const int fine[3] = {0, j, k};
    std::ptrdiff_t other[3] = {0, 0, 0};
    float weight[3] = {0.0f, 0.0f, 0.0f};
    for (int a = 1; a < 3; ++a) {
      const bool odd = fine[a] & 1;
      if (a == faces_) {
        other[a] = odd ? coarse_.stride[a] : 0;
        weight[a] = odd ? 0.5f : 0.0f;
      } else {
        other[a] = odd ? coarse_.stride[a] : -coarse_.stride[a];
        weight[a] = 0.25f;
      }
    }
    const float near = (1.0f - weight[1]) * (1.0f - weight[2]), y = weight[1] * (1.0f - weight[2]);
    const float z = (1.0f - weight[1]) * weight[2], far = weight[1] * weight[2];
    const float* c = from + coarse_.index(0, j / 2, k / 2);
    float* out = values_.data() + 1;
#pragma omp simd
    for (int i = -1; i < coarse_.n[0] + 2; ++i) {
      out[i] = near * c[i] + y * c[i + other[1]] + z * c[i + other[2]] + far * c[i + other[1] + other[2]];
    }
    return out;
  }

 private:
  const Lattice& coarse_;
  int faces_;
  std::vector<float> values_;
};

}  // namespace

// For each fine face `to` is read and written; the coarse field comes in once: 8.5 bytes, 8 flops.
void prolongateFaces(const Lattice& coarse, int axis, const float* from, const Lattice& fine, const Planes& planes,
                     const RowField<float>& weight, float* to) {
  const int pairs = (fine.faceEnd(0) + 1) / 2;
  countWork(static_cast<std::size_t>(fine.faceEnd(0)) * fine.faceEnd(1) * (planes.end - planes.first), 8.0, 8.5);
#pragma omp parallel for schedule(static) if (fine.size >= kSizeWorthSharing)
  for (int k = planes.first; k < planes.end; ++k) {
    CoarseRow interpolated(coarse, axis);
    for (int j = 0; j < fine.faceEnd(1); ++j) {
      const float* c = interpolated.at(from, j, k);
      const float* m = weight.row(fine.index(0, j, k));
      float* out = to + fine.index(0, j, k);
      if (axis == 0) {
#pragma omp simd
        for (int i = 0; i < pairs; ++i) {
          out[2 * i] += m[2 * i] * c[i];
          out[2 * i + 1] += m[2 * i + 1] * (0.5f * (c[i] + c[i + 1]));
        }
      } else {
#pragma omp simd
        for (int i = 0; i < pairs; ++i) {
          out[2 * i] += m[2 * i] * (0.75f * c[i] + 0.25f * c[i - 1]);
          out[2 * i + 1] += m[2 * i + 1] * (0.75f * c[i] + 0.25f * c[i + 1]);
        }
      }
    }
  }
}

// As prolongateFaces(), but that the mask is read.
void prolongateCells(const Lattice& coarse, const float* from, const Lattice& fine, const Planes& planes,
                     const float* mask, float* to) {
  const int pairs = (fine.n[0] + 1) / 2;
  const int end = std::min(fine.n[2], planes.end);
  countWork(static_cast<std::size_t>(fine.n[0]) * fine.n[1] * std::max(0, end - planes.first), 8.0, 12.5);
#pragma omp parallel for schedule(static) if (fine.size >= kSizeWorthSharing)
  for (int k = planes.first; k < end; ++k) {
    CoarseRow interpolated(coarse, -1);
    for (int j = 0; j < fine.n[1]; ++j) {
      const float* c = interpolated.at(from, j, k);
      const float* has = mask + fine.index(0, j, k);
      float* out = to + fine.index(0, j, k);
#pragma omp simd
      for (int i = 0; i < pairs; ++i) {
        const float low = 0.75f * c[i] + 0.25f * c[i - 1], high = 0.75f * c[i] + 0.25f * c[i + 1];
        out[2 * i] += has[2 * i] > 0.0f ? low : 0.0f;
        out[2 * i + 1] += has[2 * i + 1] > 0.0f ? high : 0.0f;
      }
    }
  }
}

#define MONOLITH_INSTANTIATE(Real)                                                                           \
  template void restrictCells(const Lattice&, const std::vector<Real>&, const Lattice&, std::vector<Real>&); \
  template void restrictFaces(const Lattice&, int, const std::vector<Real>&, const Lattice&, std::vector<Real>&);
MONOLITH_INSTANTIATE(double)
MONOLITH_INSTANTIATE(float)
#undef MONOLITH_INSTANTIATE

}  // namespace monolith
