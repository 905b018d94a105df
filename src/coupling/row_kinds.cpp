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
  const auto at = [&](int index, int axis) {
    return l.periodic[axis] ? ((index % l.n[axis]) + l.n[axis]) % l.n[axis] : std::clamp(index, 0, l.n[axis] - 1);
  };
  for (const BodyFractions& body : bodies) {
    if (body.count[0] == 0) continue;
    for (int k = body.low[2]; k < body.low[2] + body.count[2]; ++k) {
      for (int j = body.low[1]; j < body.low[1] + body.count[1]; ++j) {
        out.kinds[at(j, 1) + static_cast<std::size_t>(rows) * at(k, 2)] = RowKinds::kMixed;
      }
    }
  }
  return out;
}

}  // namespace monolith
