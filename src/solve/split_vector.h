#pragma once
// A long vector whose pieces lie apart in memory and belong to others.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace monolith {

struct SplitVector {
  std::vector<double*> pieces;
  std::ptrdiff_t length = 1;  // of each piece but the last

  // Where entry i is; those after it follow up to the end of its piece.
  double* at(std::ptrdiff_t i) const {
    const auto piece = std::min(i / length, static_cast<std::ptrdiff_t>(pieces.size()) - 1);
    return pieces[piece] + (i - piece * length);
  }
};

}  // namespace monolith
