#pragma once
// W_L^p, W_L^u and W_L^s: which part of the control volumes of pressures (cells), velocities (faces) and stresses
// (cells and edges) is liquid, solids ignored, from the level set at cell centres. Each octant of a cell is cut by
// the plane of the trilinear level set at its centre; control volumes are sums of octants, so a flat surface is exact
// at any height.

#include <array>
#include <vector>

#include "solve/staggered_operator.h"

namespace monolith {

struct LiquidFractions {
  std::vector<double> cell;                 // W_L^p, and W_L^s of the diagonal stresses
  FaceField<double> face;                   // W_L^u; of faces in walls and of edges there: the part inside the tank
  std::array<std::vector<double>, 3> edge;  // W_L^s, by pair of axes
};

// distance: cell widths, negative in the liquid. Edges only if `with_edges`. Halos are filled along periodic axes.
void sampleLiquidFractions(const Lattice& lattice, const std::vector<double>& distance, bool with_edges,
                           LiquidFractions& out);

}  // namespace monolith
