#pragma once
// Semi-Lagrangian advection along a row, four faces or cells at a time: on the same nodes with the same weights as
// advectFace() and advectCell() of advection.h one by one, so that results agree but for round-off.

#include <array>
#include <vector>

#include "solve/staggered_operator.h"

namespace monolith {

// Four faces next to each other along x; in the field they lie at any address.
using Four = double __attribute__((vector_size(32)));

// Of the faces `first` = (i, j, k) to (i + 3, j, k) of `axis`, every index below n of its axis: the velocity at their
// feet. False, and `moved` untouched, unless all of them move by less than a cell and no stencil leaves the field.
// scale: dt/h.
bool advectFour(const Lattice& lattice, const FaceField<double>& velocity, int axis, const std::array<int, 3>& first,
                double scale, Four& moved);

// The same of advectAccelerated() of advection.h: feet by the velocity `mean` of the half-way time; velocity u (limited
// tricubic) and acceleration (trilinear) there. Moves of up to half a cell.
bool advectFourAccelerated(const Lattice& lattice, const FaceField<double>& mean, const std::vector<double>& u,
                           const std::vector<double>& acceleration, int axis, const std::array<int, 3>& first,
                           double scale, Four& moved, Four& gained);

// Likewise a cell-centred field at cells.
bool advectFourCells(const Lattice& lattice, const FaceField<double>& velocity, const std::vector<double>& field,
                     const std::array<int, 3>& first, double scale, Four& moved);

}  // namespace monolith
