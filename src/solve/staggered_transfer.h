#pragma once
// Transfers between a staggered grid and the one with cells twice as wide: coarse cell I covers fine cells 2I, 2I + 1.
// Restrictions average (a right side per volume stays one); prolongations are linear.

#include <vector>

#include "solve/staggered_operator.h"

namespace monolith {

// The lattice with half as many cells, rounded up along axes with walls.
Lattice coarsened(const Lattice& fine);
bool canCoarsen(const Lattice& fine);

// Cell averages over 2 x 2 x 2.
template <class Real>
void restrictCells(const Lattice& fine, const std::vector<Real>& from, const Lattice& coarse, std::vector<Real>& to);

// Averages over the 2 x 2 faces that a coarse face consists of.
template <class Real>
void restrictFaces(const Lattice& fine, int axis, const std::vector<Real>& from, const Lattice& coarse,
                   std::vector<Real>& to);

// Those of the multigrid write the planes of `to` that they are told.

// Averages with weights 1/4, 1/2, 1/4 along the axis of the faces: the adjoint of linear interpolation there.
// The halo of `from` must be filled.
void restrictResidual(const Lattice& fine, int axis, const float* from, const Lattice& coarse, const Planes& planes,
                      float* to);

// to = factor * cell averages over 2 x 2 x 2.
void restrictResidual(const Lattice& fine, const float* from, const Lattice& coarse, const Planes& planes, float factor,
                      float* to);

// to += weight * interpolation of `from`; the halo of `from` must be filled.
void prolongateFaces(const Lattice& coarse, int axis, const float* from, const Lattice& fine, const Planes& planes,
                     const RowField<float>& weight, float* to);
// to += interpolation of `from` where mask > 0; the halo of `from` must be filled.
void prolongateCells(const Lattice& coarse, const float* from, const Lattice& fine, const Planes& planes,
                     const float* mask, float* to);

}  // namespace monolith
