#pragma once
// The operators of staggered_operator.h as compressed stencils (stencil_blocks.h), and the hot kernels of the fast
// solve. staggered_operator.* is the plain form that tests hold them against.
//
// Row of the viscous block at a face of axis a, with b, c the other two axes in order and differences taken first, so
// that large viscous numbers cost no digits of smooth fields (v, w: components b, c):
//
//   (A U)[f] = tie u[f] + n- (u[f] - u[f-a]) + n+ (u[f] - u[f+a])
//            + sum over (v, b), (w, c):  s- (u[f] - u[f-b]) + s+ (u[f] - u[f+b])
//                                       + x- (v[f] - v[f-a]) - x+ (v[f+b] - v[f+b-a])

#include <array>

#include "solve/staggered_operator.h"
#include "solve/stencil_blocks.h"

namespace monolith {

// The smoothing diagonal is that of A, raised where needed so that the spectrum of D^-1 A lies in [0, kLargestScaled]
// for sure (Gershgorin): a smoother must not diverge at a face that strong ties surround.
constexpr double kLargestScaled = 2.6;

// Places of the coefficients in a face's pattern.
struct FaceStencil {
  enum : int {
    kTie,  // mass + drag
    kNormalLow,
    kNormalHigh,
    kShearLow,
    kShearHigh = 5,  // of the pair with b; those with c follow each: kShearLow + 1, ...
    kCrossLow = 7,
    kCrossHigh = 9,
    kInverse = 11,  // 1 over the smoothing diagonal
    kTransfer,      // share of a correction that comes from the coarser level: 1 - tie to solids/diagonal
    kOpen,
    kImpulse,  // open/effective mass: what a difference of pressure gives a face while its neighbours are held
    kCount
  };
};

// Places in a cell's pattern: open parts of its faces, zero in cells without pressure.
struct CellStencil {
  enum : int { kLow, kHigh = 3, kCount = 6 };
};

template <class Real>
using FaceBlocks = StencilBlocks<Real, FaceStencil::kCount>;
template <class Real>
using CellBlocks = StencilBlocks<Real, CellStencil::kCount>;

template <class Real>
using Faces = std::array<Real*, 3>;

// Compresses a level. transfer and impulse are those of the stencils, as fields; either may be null. Of steady rows
// what is there is kept.
template <class Real, class From>
void buildFaceBlocks(const StaggeredCoefficients<From>& c, FaceBlocks<Real>& out, FaceRows<float>* transfer,
                     FaceRows<float>* impulse, const SteadyRows* steady = nullptr);
template <class Real, class From>
void buildCellBlocks(const StaggeredCoefficients<From>& c, CellBlocks<Real>& out, const SteadyRows* steady = nullptr);

// The halos of all input that is read at neighbours must be filled. Nothing is written outside of blocks.

// y = A U - C^T p
template <class Real>
void applyMomentum(const Lattice& l, const FaceBlocks<Real>& blocks, bool viscous, const Faces<const Real>& U,
                   const Real* p, const Faces<Real>& y);
// r = b - (A U - C^T p), formed in double precision
void momentumResidual(const Lattice& l, const FaceBlocks<double>& blocks, bool viscous, const Faces<const double>& b,
                      const Faces<const double>& U, const double* p, const Faces<float>& r);
// r = weight (b + C U) on cells with pressure, likewise
void divergenceResidual(const Lattice& l, const CellBlocks<double>& blocks, const double* b,
                        const Faces<const double>& U, double weight, float* r);
// y = factor * g - C U on cells with pressure; g may be null: zero.
template <class Real>
void applyDivergence(const Lattice& l, const CellBlocks<Real>& blocks, const Faces<const Real>& U, Real factor,
                     const Real* g, Real* y);

// Chebyshev on A x = b: d = keep d + scale D^-1 (b - A x), next = x + d. Forming d from two iterates instead would
// stream a fifth less and lose digits that large viscous numbers need.
void chebyshevStep(const Lattice& l, const FaceBlocks<float>& blocks, const Faces<const float>& x,
                   const Faces<const float>& b, float keep, float scale, const Faces<float>& d,
                   const Faces<float>& next);
// The first step from x = 0: d = x = scale D^-1 b.
void chebyshevStart(const FaceBlocks<float>& blocks, const Faces<const float>& b, float scale, const Faces<float>& d,
                    const Faces<float>& x);
// r = transfer (b - A x)
void transferredResidual(const Lattice& l, const FaceBlocks<float>& blocks, const Faces<const float>& x,
                         const Faces<const float>& b, const Faces<float>& r);
// y = x + impulse times the difference of p, on all faces of these planes: y is x where the impulse is zero. Halos are
// not filled.
void project(const Lattice& l, const Planes& planes, const FaceRows<float>& impulse, const Faces<const float>& x,
             const float* p, const Faces<float>& y);

}  // namespace monolith
