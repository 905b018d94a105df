#pragma once
// The cells next to one, across its six faces.

#include <array>
#include <cstddef>

#include "solve/lattice.h"

namespace monolith {

// f(cell, axis, direction): for the neighbours of a cell in the tank, beyond the end of a periodic axis too.
template <class Function>
void forEachNeighbour(const Lattice& l, std::ptrdiff_t cell, Function&& f) {
  const std::array<int, 3> here = l.cell(cell);
  for (int a = 0; a < 3; ++a) {
    for (const int direction : {-1, 1}) {
      std::array<int, 3> at = here;
      at[a] = l.wrapped(a, at[a] + direction);
      if (at[a] >= 0 && at[a] < l.n[a]) f(l.index(at[0], at[1], at[2]), a, direction);
    }
  }
}

}  // namespace monolith
