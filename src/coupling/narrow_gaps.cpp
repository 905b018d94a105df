#include "coupling/narrow_gaps.h"

#include <algorithm>
#include <cstdint>

#include "solve/neighbours.h"

namespace monolith {

void reopenNarrowGaps(const Lattice& l, FaceField<double>& fluid, std::vector<StickingPart>& parts) {
  const auto isClosed = [&](const StickingPart& p) { return !(fluid[p.axis][p.face] > 0.0); };
  if (std::none_of(parts.begin(), parts.end(), isClosed)) return;
  // Only cells with a closed face can be cut off; those next to others, across an open one, are not.
  enum State : std::uint8_t { kOther, kBesideClosed, kReached };
  std::vector<std::uint8_t> state(l.size, kOther);
  std::vector<std::ptrdiff_t> cells;
  const auto forCellsOf = [&](const StickingPart& p, auto&& f) {
    const std::array<int, 3> at = l.cell(p.face);
    for (int a = 0; a < 3; ++a) {
      if (a != p.axis && at[a] >= l.n[a]) return;  // a row of faces beyond the last cells
    }
    if (at[p.axis] < l.n[p.axis]) f(p.face);
    if (at[p.axis] > 0) {
      f(p.face - l.stride[p.axis]);
    } else if (l.periodic[p.axis]) {
      f(p.face + (l.n[p.axis] - 1) * l.stride[p.axis]);
    }
  };
  for (const StickingPart& p : parts) {
    if (!isClosed(p)) continue;
    forCellsOf(p, [&](std::ptrdiff_t c) {
      if (state[c] == kOther) cells.push_back(c);
      state[c] = kBesideClosed;
    });
  }
  // f(neighbour): across the open faces of a cell.
  const auto forEachOpen = [&](std::ptrdiff_t c, auto&& f) {
    forEachNeighbour(l, c, [&](std::ptrdiff_t n, int axis, int direction) {
      if (fluid[axis][direction < 0 ? c : n] > 0.0) f(n);
    });
  };
  std::vector<std::ptrdiff_t> reached;
  for (const auto c : cells) {
    bool open = false, leads_out = false;
    forEachOpen(c, [&](std::ptrdiff_t n) {
      open = true;
      leads_out |= state[n] == kOther;
    });
    // A cell with no open face has no pressure either.
    if (open && !leads_out) continue;
    state[c] = kReached;
    if (open) reached.push_back(c);
  }
  for (std::size_t at = 0; at < reached.size(); ++at) {
    forEachOpen(reached[at], [&](std::ptrdiff_t n) {
      if (state[n] != kBesideClosed) return;
      state[n] = kReached;
      reached.push_back(n);
    });
  }
  const auto isCutOff = [&](const StickingPart& p) {
    bool cut_off = false;
    forCellsOf(p, [&](std::ptrdiff_t c) { cut_off |= state[c] == kBesideClosed; });
    return cut_off && isClosed(p);
  };
  const auto kept =
      std::stable_partition(parts.begin(), parts.end(), [&](const StickingPart& p) { return !isCutOff(p); });
  for (auto p = kept; p != parts.end(); ++p) fluid[p->axis][p->face] = p->part;
  parts.erase(kept, parts.end());
}

}  // namespace monolith
