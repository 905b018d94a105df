#include "solve/staggered_operator.h"

namespace monolith {

template <class Real>
void computeStress(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U, StressSamples<Real>& stress) {
  const Lattice& l = c.lattice;
  const int width = l.faceEnd(0);
  stress.resize(l);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (int a = 0; a < 3; ++a) {
      const Real* u = U[a].data() + row;
      const float* k = c.normal[a].row(row);
      Real* s = stress.normal[a].data() + row;
      const auto step = l.stride[a];
#pragma omp simd
      for (int i = 0; i < width; ++i) s[i] = k[i] * (u[i + step] - u[i]);
    }
    for (int p = 0; p < 3; ++p) {
      const auto [a, b] = kShearPairs[p];
      const Real* u = U[a].data() + row;
      const Real* v = U[b].data() + row;
      const float* ku = c.shear[p][0].row(row);
      const float* kv = c.shear[p][1].row(row);
      Real* t = stress.shear[p].data() + row;
      const auto sa = l.stride[a];
      const auto sb = l.stride[b];
#pragma omp simd
      for (int i = 0; i < width; ++i) t[i] = ku[i] * (u[i] - u[i - sb]) + kv[i] * (v[i] - v[i - sa]);
    }
  });
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, stress.normal[a]);
    fillHalo(l, stress.shear[a]);
  }
}

template <class Real>
void applyMomentum(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U, const StressSamples<Real>& stress,
                   FaceField<Real>& AU) {
  const Lattice& l = c.lattice;
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (int a = 0; a < 3; ++a) {
      const Real* u = U[a].data() + row;
      const Real* m = c.mass[a].data() + row;
      Real* out = AU[a].data() + row;
      if (!c.viscous) {
#pragma omp simd
        for (int i = 0; i < width; ++i) out[i] = m[i] * u[i];
        continue;
      }
      const Real* s = stress.normal[a].data() + row;
      const auto sa = l.stride[a];
      // The two shear pairs that component a takes part in; `first` tells in which place.
      const int p = a == 2 ? 1 : 0;
      const int q = a == 0 ? 1 : 2;
      const bool p_first = kShearPairs[p][0] == a;
      const bool q_first = kShearPairs[q][0] == a;
      const auto sp = l.stride[p_first ? kShearPairs[p][1] : kShearPairs[p][0]];
      const auto sq = l.stride[q_first ? kShearPairs[q][1] : kShearPairs[q][0]];
      const Real* tp = stress.shear[p].data() + row;
      const Real* tq = stress.shear[q].data() + row;
      const float* d = c.drag[a].row(row);
      const RowField<float>&p_factor = c.shear[p][p_first ? 0 : 1], &q_factor = c.shear[q][q_first ? 0 : 1];
      const float *kp = p_factor.row(row), *kp_next = p_factor.row(row + sp);
      const float *kq = q_factor.row(row), *kq_next = q_factor.row(row + sq);
#pragma omp simd
      for (int i = 0; i < width; ++i) {
        const Real force =
            s[i - sa] - s[i] + kp[i] * tp[i] - kp_next[i] * tp[i + sp] + kq[i] * tq[i] - kq_next[i] * tq[i + sq];
        out[i] = m[i] > Real(0) ? (m[i] + d[i]) * u[i] + force : Real(0);
      }
    }
  });
}

template <class Real>
void computeDivergence(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U,
                       std::vector<Real>& divergence) {
  const Lattice& l = c.lattice;
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    const Real *u = U[0].data() + row, *v = U[1].data() + row, *w = U[2].data() + row;
    const OpenParts<Real> ou = c.open(0) + row, ov = c.open(1) + row, ow = c.open(2) + row;
    const std::uint8_t* has = c.has_pressure.data() + row;
    Real* out = divergence.data() + row;
    const auto sy = l.stride[1];
    const auto sz = l.stride[2];
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const Real sum = ou[i + 1] * u[i + 1] - ou[i] * u[i] + ov[i + sy] * v[i + sy] - ov[i] * v[i] +
                       ow[i + sz] * w[i + sz] - ow[i] * w[i];
      out[i] = has[i] ? sum : Real(0);
    }
  });
}

template <class Real>
void addPressureForce(const StaggeredCoefficients<Real>& c, const std::vector<Real>& p, Real factor,
                      FaceField<Real>& U) {
  const Lattice& l = c.lattice;
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    const Real* q = p.data() + row;
    for (int a = 0; a < 3; ++a) {
      const OpenParts<Real> o = c.open(a) + row;
      Real* u = U[a].data() + row;
      const auto sa = l.stride[a];
#pragma omp simd
      for (int i = 0; i < width; ++i) u[i] += factor * o[i] * (q[i - sa] - q[i]);
    }
  });
}

template <class To, class From>
void convertCoefficients(const StaggeredCoefficients<From>& c, StaggeredCoefficients<To>& out) {
  const auto copy = [](const auto& from, auto& to) {
    for (std::size_t a = 0; a < from.size(); ++a) {
      to[a].resize(from[a].size());
      const auto* x = from[a].data();
      auto* y = to[a].data();
#pragma omp parallel for simd schedule(static) if (from[a].size() >= kSizeWorthSharing)
      for (std::size_t i = 0; i < from[a].size(); ++i) y[i] = static_cast<std::decay_t<decltype(y[i])>>(x[i]);
    }
  };
  out.lattice = c.lattice;
  out.viscous = c.viscous;
  copy(c.mass, out.mass);
  copy(c.fluid(), out.own_fluid);
  out.drag = c.drag;
  out.normal = c.normal;
  out.shear = c.shear;
  out.has_pressure = c.has_pressure;
}

#define MONOLITH_INSTANTIATE(Real)                                                                                    \
  template void computeStress(const StaggeredCoefficients<Real>&, const FaceField<Real>&, StressSamples<Real>&);      \
  template void applyMomentum(const StaggeredCoefficients<Real>&, const FaceField<Real>&, const StressSamples<Real>&, \
                              FaceField<Real>&);                                                                      \
  template void computeDivergence(const StaggeredCoefficients<Real>&, const FaceField<Real>&, std::vector<Real>&);    \
  template void addPressureForce(const StaggeredCoefficients<Real>&, const std::vector<Real>&, Real, FaceField<Real>&);
MONOLITH_INSTANTIATE(double)
MONOLITH_INSTANTIATE(float)
#undef MONOLITH_INSTANTIATE
template void convertCoefficients(const StaggeredCoefficients<double>&, StaggeredCoefficients<float>&);

}  // namespace monolith
