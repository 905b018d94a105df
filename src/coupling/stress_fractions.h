#pragma once
// W_F^s and W_Si^s: how the control volumes of stress samples, cubes of width h about cell centres and about the
// middles of edges, are shared among bodies, wall and the liquid's side. sum_i W_Si + W_wall + W_F = 1, also where
// bodies touch or overlap and where an edge lies in a wall, of whose cube a half or three quarters are the wall's.

#include <array>
#include <vector>

#include "coupling/solid_fractions.h"

namespace monolith {

struct StressFractions {
  std::vector<double> cell;
  std::array<std::vector<double>, 3> edge;  // by pair of axes, kShearPairs
};

// Part of an edge's control volume that lies inside the tank: 1, 1/2 or 1/4.
double edgeInTank(const Lattice& lattice, int pair, const std::array<int, 3>& at);

// `fluid`: W_F^s, halo filled along periodic axes, zero beyond walls. `parts`: W_Si^s of each body on the box of its
// fractions in `solids`.
void sampleStressFractions(const MacGrid& grid, const std::vector<RigidBody>& bodies, const SolidFractions& solids,
                           StressFractions& fluid, std::vector<StressFractions>& parts);

// W_F^s of a coarse level, from its cells alone: an edge takes the mean of the four around it.
void edgesFromCells(const Lattice& lattice, StressFractions& fluid);

}  // namespace monolith
