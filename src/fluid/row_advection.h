#pragma once
// Semi-Lagrangian advection along a row, four faces or cells at a time: on the same nodes with the same weights as
// advectFace() and advectCell() of advection.h one by one, so that results agree but for round-off.

#include <cstdint>
#include <vector>

#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

// Four faces next to each other along x; in the field they lie at any address.
using Four = double __attribute__((vector_size(32)));

// Of the faces (i .. i + 3, j, k) of `axis`, every index from 1 to n - 1 of its axis: the velocity at their feet. False, and
// `moved` untouched, unless all of them move by less than a cell. scale: dt/h.
bool advectFour(const Lattice& lattice, const FaceField<double>& velocity, int axis, std::ptrdiff_t face, double scale,
                Four& moved);

// Likewise a cell-centred field at cells.
bool advectFourCells(const Lattice& lattice, const FaceField<double>& velocity, const std::vector<double>& field,
                     std::ptrdiff_t cell, double scale, Four& moved);

}  // namespace monolith
