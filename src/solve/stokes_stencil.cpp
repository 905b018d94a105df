#include "solve/stokes_stencil.h"

#include <algorithm>

#include "solve/kernel_work.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

using S = FaceStencil;

// The axes besides a, in order, and where component a stands in their shear pairs.
struct Others {
  int axis[2];
  int pair[2];
  int place[2];
};
constexpr Others kOthers[3] = {{{1, 2}, {0, 1}, {0, 0}}, {{0, 2}, {0, 2}, {1, 0}}, {{0, 1}, {1, 2}, {1, 1}}};

// A U of the lanes from f on. Over the pattern's 11 and the fields' 15 loads a face, all but three of which hit the
// first cache: bound by its load ports.
constexpr double kMomentumFlops = 31.0;
template <class Real>
inline void momentum(const Lattice& l, int a, std::ptrdiff_t f, const Real* k, const Faces<const Real>& U, Real* out) {
  const auto sa = l.stride[a];
  const auto sb = l.stride[kOthers[a].axis[0]], sc = l.stride[kOthers[a].axis[1]];
  const Real* u = U[a] + f;
  const Real* v = U[kOthers[a].axis[0]] + f;
  const Real* w = U[kOthers[a].axis[1]] + f;
#pragma omp simd
  for (int i = 0; i < kLanes; ++i) {
    const Real at = u[i];
    const Real own = k[i] * at + k[S::kNormalLow * kLanes + i] * (at - u[i - sa]) +
                     k[S::kNormalHigh * kLanes + i] * (at - u[i + sa]);
    const Real shear =
        k[S::kShearLow * kLanes + i] * (at - u[i - sb]) + k[(S::kShearLow + 1) * kLanes + i] * (at - u[i - sc]) +
        k[S::kShearHigh * kLanes + i] * (at - u[i + sb]) + k[(S::kShearHigh + 1) * kLanes + i] * (at - u[i + sc]);
    const Real cross = k[S::kCrossLow * kLanes + i] * (v[i] - v[i - sa]) -
                       k[S::kCrossHigh * kLanes + i] * (v[i + sb] - v[i + sb - sa]) +
                       k[(S::kCrossLow + 1) * kLanes + i] * (w[i] - w[i - sa]) -
                       k[(S::kCrossHigh + 1) * kLanes + i] * (w[i + sc] - w[i + sc - sa]);
    out[i] = own + shear + cross;
  }
}

// store(i, A U - C^T p) of the lanes from f on.
template <class Real, class Store>
inline void momentumAndPressure(const Lattice& l, int a, std::ptrdiff_t f, const Real* k, bool viscous,
                                const Faces<const Real>& U, const Real* p, Store&& store) {
  const Real *here = p + f, *before = here - l.stride[a], *open = k + S::kOpen * kLanes;
  if (viscous) {
    Real Au[kLanes];
    momentum(l, a, f, k, U, Au);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) store(i, Au[i] - open[i] * (before[i] - here[i]));
  } else {
    const Real* u = U[a] + f;
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) store(i, k[i] * u[i] - open[i] * (before[i] - here[i]));
  }
}

// store(i, C U, whether the cell has pressure) of the lanes from c on: one with pressure has at least one open face.
template <class Real, class Store>
inline void divergence(const Lattice& l, std::ptrdiff_t c, const Real* k, const Faces<const Real>& U, Store&& store) {
  const auto sy = l.stride[1], sz = l.stride[2];
  const Real *u = U[0] + c, *v = U[1] + c, *w = U[2] + c;
#pragma omp simd
  for (int i = 0; i < kLanes; ++i) {
    const Real flux = k[3 * kLanes + i] * u[i + 1] - k[i] * u[i] + k[4 * kLanes + i] * v[i + sy] -
                      k[kLanes + i] * v[i] + k[5 * kLanes + i] * w[i + sz] - k[2 * kLanes + i] * w[i];
    const Real open =
        k[i] + k[kLanes + i] + k[2 * kLanes + i] + k[3 * kLanes + i] + k[4 * kLanes + i] + k[5 * kLanes + i];
    store(i, flux, open > Real(0));
  }
}

template <class Value>
bool isZero(const Value* values, int size) {
  return std::all_of(values, values + size, [](Value value) { return value == Value(0); });
}

// Coefficients of a row of faces.
template <class Real, class From>
void fillFaceRow(const StaggeredCoefficients<From>& c, int a, std::ptrdiff_t row, int width,
                 typename FaceBlocks<Real>::Row& out) {
  const Lattice& l = c.lattice;
  const auto sa = l.stride[a];
  const From* m = c.mass[a].data() + row;
  const From* fluid = c.fluid()[a].data() + row;
  std::array<Real*, S::kCount> k;
  for (int q = 0; q < S::kCount; ++q) k[q] = out[q].data();
  // Until the end, kInverse holds the diagonal, kTransfer the ties, kOpen the sum of what is off the diagonal.
  if (!c.viscous) {
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      for (int q = S::kNormalLow; q < S::kInverse; ++q) k[q][i] = Real(0);
      k[S::kTie][i] = k[S::kInverse][i] = m[i];
      k[S::kTransfer][i] = m[i];
    }
  } else {
    const float* drag = c.drag[a].row(row);
    const float *lows = c.normal[a].row(row - sa), *highs = c.normal[a].row(row);
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const Real low = lows[i], high = highs[i];
      const bool has_low = m[i - sa] > From(0), has_high = m[i + sa] > From(0);
      const Real tie = m[i] + drag[i];
      k[S::kTie][i] = tie;
      k[S::kNormalLow][i] = low;
      k[S::kNormalHigh][i] = high;
      k[S::kInverse][i] = tie + low + high;
      k[S::kTransfer][i] = tie + (has_low ? Real(0) : low) + (has_high ? Real(0) : high);
      k[S::kOpen][i] = (has_low ? low : Real(0)) + (has_high ? high : Real(0));
    }
    for (int o = 0; o < 2; ++o) {
      const int b = kOthers[a].axis[o], place = kOthers[a].place[o];
      const auto sb = l.stride[b];
      const RowField<float>& owns = c.shear[kOthers[a].pair[o]][place];
      const RowField<float>& others = c.shear[kOthers[a].pair[o]][1 - place];
      const float *own = owns.row(row), *own_next = owns.row(row + sb);
      const float *other = others.row(row), *other_next = others.row(row + sb);
      const From* mb = c.mass[b].data() + row;
      Real *s_low = k[S::kShearLow + o], *s_high = k[S::kShearHigh + o], *x_low = k[S::kCrossLow + o],
           *x_high = k[S::kCrossHigh + o];
#pragma omp simd
      for (int i = 0; i < width; ++i) {
        const Real low = Real(own[i]) * Real(own[i]), high = Real(own_next[i]) * Real(own_next[i]);
        const bool has_low = m[i - sb] > From(0), has_high = m[i + sb] > From(0);
        const Real cross_low = Real(own[i]) * Real(other[i]), cross_high = Real(own_next[i]) * Real(other_next[i]);
        s_low[i] = low;
        s_high[i] = high;
        x_low[i] = cross_low;
        x_high[i] = cross_high;
        k[S::kInverse][i] += low + high;
        k[S::kTransfer][i] += (has_low ? Real(0) : low) + (has_high ? Real(0) : high);
        k[S::kOpen][i] += (has_low ? low : Real(0)) + (has_high ? high : Real(0)) +
                          (mb[i] > From(0) ? cross_low : Real(0)) + (mb[i - sa] > From(0) ? cross_low : Real(0)) +
                          (mb[i + sb] > From(0) ? cross_high : Real(0)) +
                          (mb[i + sb - sa] > From(0) ? cross_high : Real(0));
      }
    }
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      k[S::kInverse][i] = std::max(k[S::kInverse][i], (k[S::kInverse][i] + k[S::kOpen][i]) / Real(kLargestScaled));
    }
  }
#pragma omp simd
  for (int i = 0; i < width; ++i) {
    const bool has = m[i] > From(0);
    const Real diagonal = has ? k[S::kInverse][i] : Real(1);
    const Real effective = has ? k[S::kTransfer][i] : Real(1);
    k[S::kInverse][i] = Real(1) / diagonal;
    k[S::kTransfer][i] = std::max(Real(0), Real(1) - (effective - Real(m[i])) / diagonal);
    k[S::kOpen][i] = fluid[i];
    k[S::kImpulse][i] = Real(fluid[i]) / effective;
  }
  for (int i = 0; i < width; ++i) {
    if (m[i] > From(0)) continue;
    for (auto& q : k) q[i] = Real(0);
  }
}

}  // namespace

template <class Real, class From>
void buildFaceBlocks(const StaggeredCoefficients<From>& c, FaceBlocks<Real>& out, FaceRows<float>* transfer,
                     FaceRows<float>* impulse, const SteadyRows* steady) {
  const Lattice& l = c.lattice;
  const bool keeps = out.wouldKeep(steady);
  // Along the rows of their own axis faces on the low wall have no unknown.
  const std::vector<int> first = {l.periodic[0] ? 0 : 1, 0, 0};
  out.build(
      l, first,
      [&](int a, std::ptrdiff_t row, int width, typename FaceBlocks<Real>::Row& k) {
        if (isZero(c.mass[a].data() + row, width)) return false;
        fillFaceRow<Real>(c, a, row, width, k);
        return true;
      },
      steady);
  for (const auto& [fields, place] : {std::pair(transfer, S::kTransfer), std::pair(impulse, S::kImpulse)}) {
    if (fields == nullptr) continue;
    bool all = !keeps;
    for (auto& field : *fields) {
      all = all || field.empty();
      field.reshape(l);
    }
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l.faceEnd(2); ++k) {
      if (!all && !out.changed(k)) continue;
      FaceField<float> plane;
      for (auto& field : plane) field.assign(l.stride[2], 0.0F);
      out.forEachOfPlane(k, [&, place = place](int a, std::ptrdiff_t f, const Real* values) {
        float* to = plane[a].data() + (f - l.planeBegin(k));
        for (int i = 0; i < kLanes; ++i) to[i] = static_cast<float>(values[place * kLanes + i]);
      });
      for (int a = 0; a < 3; ++a) (*fields)[a].packPlane(k, plane[a]);
    }
    for (auto& field : *fields) field.shareImages();
  }
}

template <class Real, class From>
void buildCellBlocks(const StaggeredCoefficients<From>& c, CellBlocks<Real>& out, const SteadyRows* steady) {
  const Lattice& l = c.lattice;
  out.build(l, {0}, [&](int, std::ptrdiff_t row, int width, typename CellBlocks<Real>::Row& k) {
    const std::uint8_t* has = c.has_pressure.data() + row;
    if (isZero(has, width)) return false;
    for (int a = 0; a < 3; ++a) {
      const OpenParts<From> open = c.open(a) + row;
      for (int i = 0; i < width; ++i) {
        k[CellStencil::kLow + a][i] = has[i] ? Real(open[i]) : Real(0);
        k[CellStencil::kHigh + a][i] = has[i] ? Real(open[i + l.stride[a]]) : Real(0);
      }
    }
    return true;
  }, steady);
}

// Streams U, p and y: 28 bytes a cell in single precision; see momentum() for the loads.
template <class Real>
void applyMomentum(const Lattice& l, const FaceBlocks<Real>& blocks, bool viscous, const Faces<const Real>& U,
                   const Real* p, const Faces<Real>& y) {
  countWork(blocks.lanes(), (viscous ? kMomentumFlops : 1.0) + 3.0, sizeof(Real) * (2.0 + 1.0 / 3.0));
  blocks.forEach([&](int a, std::ptrdiff_t f, const Real* k) {
    Real* out = y[a] + f;
    momentumAndPressure(l, a, f, k, viscous, U, p, [=](int i, Real sum) { out[i] = sum; });
  });
}

// Streams U, p, b and r: 68 bytes a cell; bound by memory.
void momentumResidual(const Lattice& l, const FaceBlocks<double>& blocks, bool viscous, const Faces<const double>& b,
                      const Faces<const double>& U, const double* p, const Faces<float>& r) {
  countWork(blocks.lanes(), (viscous ? kMomentumFlops : 1.0) + 4.0, sizeof(double) * (2.0 + 1.0 / 3.0) + sizeof(float));
  blocks.forEach([&](int a, std::ptrdiff_t f, const double* k) {
    const double* right = b[a] + f;
    float* out = r[a] + f;
    momentumAndPressure(l, a, f, k, viscous, U, p,
                        [=](int i, double sum) { out[i] = static_cast<float>(right[i] - sum); });
  });
}

// Streams U, y and perhaps g: 16 or 20 bytes a cell in single precision for 12 or 13 flops: bound by the second cache
// or memory.
template <class Real>
void applyDivergence(const Lattice& l, const CellBlocks<Real>& blocks, const Faces<const Real>& U, Real factor,
                     const Real* g, Real* y) {
  countWork(blocks.lanes(), g != nullptr ? 13.0 : 12.0, sizeof(Real) * (g != nullptr ? 5.0 : 4.0));
  blocks.forEach([&](int, std::ptrdiff_t c, const Real* k) {
    Real start[kLanes] = {};
    if (g != nullptr) {
#pragma omp simd
      for (int i = 0; i < kLanes; ++i) start[i] = factor * g[c + i];
    }
    Real* out = y + c;
    const Real* from = start;
    divergence(l, c, k, U, [=](int i, Real flux, bool has) { out[i] = has ? from[i] - flux : Real(0); });
  });
}

// Streams U, b and r: 36 bytes a cell for 13 flops; bound by memory.
void divergenceResidual(const Lattice& l, const CellBlocks<double>& blocks, const double* b,
                        const Faces<const double>& U, double weight, float* r) {
  countWork(blocks.lanes(), 13.0, 4.0 * sizeof(double) + sizeof(float));
  blocks.forEach([&](int, std::ptrdiff_t c, const double* k) {
    const double* right = b + c;
    float* out = r + c;
    divergence(l, c, k, U, [=](int i, double flux, bool has) {
      out[i] = has ? static_cast<float>(weight * (right[i] + flux)) : 0.0f;
    });
  });
}

// Streams x, b, d (read and written) and next: 60 bytes a cell for 111 flops. In cache bound by loads, beyond by
// memory.
void chebyshevStep(const Lattice& l, const FaceBlocks<float>& blocks, const Faces<const float>& x,
                   const Faces<const float>& b, float keep, float scale, const Faces<float>& d,
                   const Faces<float>& next) {
  countWork(blocks.lanes(), kMomentumFlops + 6.0, 5.0 * sizeof(float));
  blocks.forEach([&](int a, std::ptrdiff_t f, const float* k) {
    float Ax[kLanes];
    momentum(l, a, f, k, x, Ax);
    const float *from = x[a] + f, *right = b[a] + f;
    float *step = d[a] + f, *to = next[a] + f;
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) {
      step[i] = keep * step[i] + scale * k[S::kInverse * kLanes + i] * (right[i] - Ax[i]);
      to[i] = from[i] + step[i];
    }
  });
}

// 36 bytes a cell; bound by memory.
void chebyshevStart(const FaceBlocks<float>& blocks, const Faces<const float>& b, float scale, const Faces<float>& d,
                    const Faces<float>& x) {
  countWork(blocks.lanes(), 2.0, 3.0 * sizeof(float));
  blocks.forEach([&](int a, std::ptrdiff_t f, const float* k) {
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) {
      x[a][f + i] = d[a][f + i] = scale * k[S::kInverse * kLanes + i] * b[a][f + i];
    }
  });
}

// 36 bytes a cell for 99 flops: as chebyshevStep().
void transferredResidual(const Lattice& l, const FaceBlocks<float>& blocks, const Faces<const float>& x,
                         const Faces<const float>& b, const Faces<float>& r) {
  countWork(blocks.lanes(), kMomentumFlops + 2.0, 3.0 * sizeof(float));
  blocks.forEach([&](int a, std::ptrdiff_t f, const float* k) {
    float Ax[kLanes];
    momentum(l, a, f, k, x, Ax);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) r[a][f + i] = k[S::kTransfer * kLanes + i] * (b[a][f + i] - Ax[i]);
  });
}

// 28 bytes a cell for 9 flops, bound by memory; the impulse stays in the first cache.
void project(const Lattice& l, const Planes& planes, const FaceRows<float>& impulse, const Faces<const float>& x,
             const float* p, const Faces<float>& y) {
  countWork(static_cast<std::size_t>(3 * l.stride[2] * (planes.end - planes.first)), 3.0,
            sizeof(float) * (2.0 + 1.0 / 3.0));
  const std::ptrdiff_t width = l.stride[1];
#pragma omp parallel for schedule(static)
  for (int k = planes.first; k < planes.end; ++k) {
    for (int a = 0; a < 3; ++a) {
      for (auto row = l.planeBegin(k); row < l.planeBegin(k + 1); row += width) {
        const float *here = p + row, *before = here - l.stride[a];
        const float *g = impulse[a].row(row), *from = x[a] + row;
        float* to = y[a] + row;
#pragma omp simd
        for (std::ptrdiff_t f = 0; f < width; ++f) to[f] = from[f] + g[f] * (before[f] - here[f]);
      }
    }
  }
}

#define MONOLITH_INSTANTIATE(Real, From)                                                                 \
  template void buildFaceBlocks(const StaggeredCoefficients<From>&, FaceBlocks<Real>&, FaceRows<float>*, \
                                FaceRows<float>*, const SteadyRows*);                                    \
  template void buildCellBlocks(const StaggeredCoefficients<From>&, CellBlocks<Real>&, const SteadyRows*);
MONOLITH_INSTANTIATE(double, double)
MONOLITH_INSTANTIATE(float, double)
MONOLITH_INSTANTIATE(float, float)
#undef MONOLITH_INSTANTIATE
#define MONOLITH_INSTANTIATE(Real)                                                                                    \
  template void applyMomentum(const Lattice&, const FaceBlocks<Real>&, bool, const Faces<const Real>&, const Real*,   \
                              const Faces<Real>&);                                                                    \
  template void applyDivergence(const Lattice&, const CellBlocks<Real>&, const Faces<const Real>&, Real, const Real*, \
                                Real*);
MONOLITH_INSTANTIATE(double)
MONOLITH_INSTANTIATE(float)
#undef MONOLITH_INSTANTIATE

}  // namespace monolith
