#pragma once
// Semi-Lagrangian advection of a row of faces, four at a time. What advectFace() of advection.cpp does one by one, on the
// same nodes with the same weights: results agree but for round-off.

#include <cstdint>
#include <vector>

#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

// Four faces next to each other along x; in the field they lie at any address.
using Four = double __attribute__((vector_size(32)));

// Of the faces (i .. i + 3, j, k) of `axis`, every index from 1 to n - 1 of its axis: the velocity at their feet, if they move
// by less than a cell, all of them into the same octant. False otherwise, `moved` is then untouched. scale: dt/h.
bool advectFour(const Lattice& lattice, const FaceField<double>& velocity, int axis, std::ptrdiff_t face, double scale,
                Four& moved);

}  // namespace monolith
