#pragma once
// What is around each row of cells: where neither a body nor the surface is near, coefficients follow from the tank's
// walls, the viscous number and the kind alone, and hold until one of them changes (solve/steady_rows.h).

#include <cstdint>
#include <vector>

#include "coupling/solid_fractions.h"
#include "solve/steady_rows.h"

namespace monolith {

struct RowKinds {
  enum Kind : std::uint8_t { kMixed = SteadyRows::kChanging, kLiquid, kAir };

  std::vector<std::uint8_t> kinds;  // of rows of cells, j fastest
  bool full = false;                // no surface anywhere
};

// liquid_distance in cell widths, cell centres.
RowKinds findRowKinds(const Lattice& lattice, const std::vector<BodyFractions>& bodies,
                      const std::vector<double>& liquid_distance);

}  // namespace monolith
