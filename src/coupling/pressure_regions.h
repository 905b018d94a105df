#pragma once
// Connected regions of cells with pressure. A region without a free surface is sealed: its pressure is free up to a
// constant, and its solids must not change its volume (DESIGN 1.5).

#include <cstdint>
#include <vector>

#include "coupling/stokes_coefficients.h"

namespace monolith {

struct PressureRegion {
  bool sealed = false;              // no face towards the air
  bool null_mode = false;           // sealed, and no free body feels the constant: it is in the operator's null space
  std::vector<std::int32_t> cells;  // of sealed regions only
};

// `moves[b]`: body b's twist is an unknown.
std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& coefficients,
                                                const BodyRows& rows, const std::vector<char>& moves);

}  // namespace monolith
