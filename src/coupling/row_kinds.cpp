#include "coupling/row_kinds.h"

#include <algorithm>

namespace monolith {
namespace {

// Cell widths from the surface, beyond which no part of a cell, face or edge of the row is cut.
constexpr double kClear = 0.75;

}  // namespace

RowKinds findRowKinds(const Lattice& l, const std::vector<BodyFractions>& bodies,
                      const std::vector<double>& liquid_distance) {
  RowKinds out;
  const int rows = l.n[1];
  out.kinds.assign(static_cast<std::size_t>(rows) * l.n[2], RowKinds::kMixed);
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= rows || k >= l.n[2]) return;
    const double* d = liquid_distance.data() + row;
    double least = d[0], most = d[0];
#pragma omp simd reduction(min : least) reduction(max : most)
    for (int i = 0; i < l.n[0]; ++i) {
      least = std::min(least, d[i]);
      most = std::max(most, d[i]);
    }
    out.kinds[j + static_cast<std::size_t>(rows) * k] = most < -kClear   ? RowKinds::kLiquid
                                                        : least > kClear ? RowKinds::kAir
                                                                         : RowKinds::kMixed;
  });
  out.full = std::all_of(out.kinds.begin(), out.kinds.end(), [](auto kind) { return kind == RowKinds::kLiquid; });
  // The last rows of faces count with the cells before them.
  const std::vector<std::uint8_t> near_body = rowsOfBodies(l, bodies);
  for (int k = 0; k < l.faceEnd(2); ++k) {
    for (int j = 0; j < l.faceEnd(1); ++j) {
      if (!near_body[j + static_cast<std::size_t>(l.faceEnd(1)) * k]) continue;
      out.kinds[std::min(j, rows - 1) + static_cast<std::size_t>(rows) * std::min(k, l.n[2] - 1)] = RowKinds::kMixed;
    }
  }
  return out;
}

}  // namespace monolith
