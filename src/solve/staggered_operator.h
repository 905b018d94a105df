#pragma once
// Matrix-free operators of one Stokes step on a staggered grid, from per-sample coefficients. Numerics only: what the
// coefficients mean physically is decided in coupling/.
//
// Velocities U_a (a = 0, 1, 2) live on faces, zero wherever mass[a] is zero. With s_a[c] = U_a at the face called c:
//   normal sample of cell c, axis a:   s = normal[a][c] (U_a[c + a] - U_a[c])
//   shear sample of edge c, pair (a,b):
//                      t = shear[ab].first (U_a[c] - U_a[c - b]) + shear[ab].second (U_b[c] - U_b[c - a])
//   viscous block   A U = mass U + drag U + D^T (s, t)        symmetric, positive definite where mass > 0
//   divergence      (C U)[c] = sum_a open[a][c + a] U_a[c + a] - open[a][c] U_a[c], on cells with pressure;
//                   open: part of a face that is fluid, 0 where mass is 0
//   pressure block  L = C mass^-1 C^T                          symmetric, positive semi-definite
// All of it dimensionless: velocities in m/s, every coefficient a ratio (coupling/stokes_coefficients.h).

#include <array>
#include <cstdint>
#include <vector>

#include "solve/lattice.h"
#include "solve/row_field.h"

namespace monolith {

// The three pairs of axes of the shear samples: edge arrays are indexed by pair.
constexpr int kShearPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};

// Index of an edge that may lie in a periodic image; -1 outside the tank.
inline std::ptrdiff_t edgeIndex(const Lattice& l, int pair, const std::array<int, 3>& at) {
  std::array<bool, 3> faces = {};
  for (const int a : kShearPairs[pair]) faces[a] = true;
  return l.indexInTank(at, faces);
}

template <class Real>
using FaceField = std::array<std::vector<Real>, 3>;
using FaceMask = FaceField<std::uint8_t>;  // 1 or 0

// open of the faces along an axis, or of those from one on.
template <class Real>
struct OpenParts {
  const Real* mass;
  const Real* fluid;
  Real operator[](std::ptrdiff_t face) const { return mass[face] > Real(0) ? fluid[face] : Real(0); }
  OpenParts operator+(std::ptrdiff_t faces) const { return {mass + faces, fluid + faces}; }
};

template <class Real>
struct StaggeredCoefficients {
  Lattice lattice;
  bool viscous = false;
  FaceField<Real> mass;  // liquid part of the face's control volume; 0: no unknown
  // Part of it that is not solid: own, or somebody's field, which must outlive the coefficients' use.
  FaceField<Real> own_fluid;
  const FaceField<Real>* others_fluid = nullptr;
  FaceRows<float> drag;                                 // tie of a face to the solid it lies in
  FaceRows<float> normal;                               // per cell and axis
  std::array<std::array<RowField<float>, 2>, 3> shear;  // per pair: factor of the first, of the second component
  std::vector<std::uint8_t> has_pressure;               // per cell

  const FaceField<Real>& fluid() const { return others_fluid != nullptr ? *others_fluid : own_fluid; }
  OpenParts<Real> open(int axis) const { return {mass[axis].data(), fluid()[axis].data()}; }

  // All zero, but for another's field.
  void resize(const Lattice& l, bool with_viscosity) {
    lattice = l;
    viscous = with_viscosity;
    for (int a = 0; a < 3; ++a) {
      mass[a].assign(l.size, Real(0));
      own_fluid[a].assign(others_fluid != nullptr ? 0 : l.size, Real(0));
    }
    has_pressure.assign(l.size, 0);
    forEachViscous([&](RowField<float>& field) {
      field.clear();
      if (viscous) field.reshape(l);
    });
  }
  // f(field) for those that viscosity makes.
  template <class Function>
  void forEachViscous(Function&& f) {
    for (int a = 0; a < 3; ++a) {
      f(drag[a]);
      f(normal[a]);
      for (auto& field : shear[a]) f(field);
    }
  }
};

// A plane of the coefficients that viscosity makes, to be written entry by entry.
struct ViscousPlane {
  std::ptrdiff_t begin = 0;  // of the lattice: where its entries start
  FaceField<float> drag, normal;
  std::array<std::array<std::vector<float>, 2>, 3> shear;

  template <class Real>
  void unpack(const StaggeredCoefficients<Real>& c, int k) {
    begin = c.lattice.planeBegin(k);
    for (int a = 0; a < 3; ++a) {
      c.drag[a].unpackPlane(k, drag[a]);
      c.normal[a].unpackPlane(k, normal[a]);
      for (int s = 0; s < 2; ++s) c.shear[a][s].unpackPlane(k, shear[a][s]);
    }
  }
  template <class Real>
  void pack(int k, StaggeredCoefficients<Real>& c) {
    for (int a = 0; a < 3; ++a) {
      c.drag[a].packPlane(k, drag[a]);
      c.normal[a].packPlane(k, normal[a]);
      for (int s = 0; s < 2; ++s) c.shear[a][s].packPlane(k, shear[a][s]);
    }
  }
};

// Viscous stress samples of a velocity field: normal[a] per cell, shear[pair] per edge (t above, unscaled).
template <class Real>
struct StressSamples {
  FaceField<Real> normal;
  FaceField<Real> shear;

  void resize(const Lattice& l) {
    for (int a = 0; a < 3; ++a) {
      normal[a].resize(l.size);
      shear[a].resize(l.size);
    }
  }
};

// Samples of U; U's halo must be filled.
template <class Real>
void computeStress(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U, StressSamples<Real>& stress);

// AU = (mass + drag) U + D^T stress. The halo of the stress must be filled. Rows without an unknown give zero.
template <class Real>
void applyMomentum(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U, const StressSamples<Real>& stress,
                   FaceField<Real>& AU);

// divergence = C U on cells with pressure, zero elsewhere.
template <class Real>
void computeDivergence(const StaggeredCoefficients<Real>& c, const FaceField<Real>& U, std::vector<Real>& divergence);

// U_a += factor * (C^T p)_a on faces with an unknown; p's halo must be filled.
template <class Real>
void addPressureForce(const StaggeredCoefficients<Real>& c, const std::vector<Real>& p, Real factor,
                      FaceField<Real>& U);

// The same coefficients in another precision.
template <class To, class From>
void convertCoefficients(const StaggeredCoefficients<From>& c, StaggeredCoefficients<To>& out);

}  // namespace monolith
