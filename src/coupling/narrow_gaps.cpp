#include "coupling/narrow_gaps.h"

#include <algorithm>
#include <cstdint>

#include "solve/neighbours.h"

namespace monolith {
namespace {

enum State : std::uint8_t {
  kOther,  // no face closed by sticking
  kShut,   // no open face either
  kCutOff,
  kReached,  // leads out: across open faces, or, without any, along the closed ones to a cell that does
};

class Gaps {
 public:
  Gaps(const Lattice& l, const FaceField<double>& fluid, const std::vector<StickingPart>& parts)
      : l_(l), fluid_(fluid), state_(l.size, kOther) {
    for (const StickingPart& p : parts) {
      if (isClosed(p)) closed_.push_back(&p);
    }
  }

  bool isClosed(const StickingPart& p) const { return !(fluid_[p.axis][p.face] > 0.0); }
  bool anyClosed() const { return !closed_.empty(); }

  void findCutOff(const std::vector<double>& liquid_distance) {
    followOpenFaces();
    spread(kReached);
    spread(kCutOff);
    if (shut_ > 0 && !hasPressure(liquid_distance)) {
      std::replace<decltype(state_)::iterator, std::uint8_t>(state_.begin(), state_.end(), kShut, kCutOff);
    }
  }

  bool isCutOff(const StickingPart& p) const {
    bool cut_off = false;
    forCellsOf(p, [&](std::ptrdiff_t c) { cut_off |= state_[c] == kCutOff; });
    return cut_off && isClosed(p);
  }

 private:
  // f(cell): on both sides of a face, in the tank.
  template <class Function>
  void forCellsOf(const StickingPart& p, Function&& f) const {
    const std::array<int, 3> at = l_.cell(p.face);
    for (int a = 0; a < 3; ++a) {
      if (a != p.axis && at[a] >= l_.n[a]) return;  // a row of faces beyond the last cells
    }
    if (at[p.axis] < l_.n[p.axis]) f(p.face);
    if (at[p.axis] > 0) {
      f(p.face - l_.stride[p.axis]);
    } else if (l_.periodic[p.axis]) {
      f(p.face + (l_.n[p.axis] - 1) * l_.stride[p.axis]);
    }
  }

  // f(neighbour): across the open faces of a cell.
  template <class Function>
  void forEachOpen(std::ptrdiff_t c, Function&& f) const {
    forEachNeighbour(l_, c, [&](std::ptrdiff_t n, int axis, int direction) {
      if (fluid_[axis][direction < 0 ? c : n] > 0.0) f(n);
    });
  }

  // Only cells with a closed face can be cut off; those next to others, across an open one, are not.
  void followOpenFaces() {
    std::vector<std::ptrdiff_t> cells;
    for (const StickingPart* p : closed_) {
      forCellsOf(*p, [&](std::ptrdiff_t c) {
        if (state_[c] == kOther) cells.push_back(c);
        state_[c] = kCutOff;
      });
    }
    std::vector<std::ptrdiff_t> reached;
    for (const auto c : cells) {
      bool open = false, leads_out = false;
      forEachOpen(c, [&](std::ptrdiff_t n) {
        open = true;
        leads_out |= state_[n] == kOther;
      });
      if (!open) {
        state_[c] = kShut;
        ++shut_;
      } else if (leads_out) {
        state_[c] = kReached;
        reached.push_back(c);
      }
    }
    for (std::size_t at = 0; at < reached.size(); ++at) {
      forEachOpen(reached[at], [&](std::ptrdiff_t n) {
        if (state_[n] != kCutOff) return;
        state_[n] = kReached;
        reached.push_back(n);
      });
    }
  }

  // Along closed faces from cells of a state to all that are shut. Most are next to one: surfaces run through both.
  void spread(State state) {
    for (bool found = true; found && shut_ > 0;) {
      found = false;
      for (const StickingPart* p : closed_) {
        bool beside = false;
        forCellsOf(*p, [&](std::ptrdiff_t c) { beside |= state_[c] == state; });
        if (!beside) continue;
        forCellsOf(*p, [&](std::ptrdiff_t c) {
          if (state_[c] != kShut) return;
          state_[c] = state;
          --shut_;
          found = true;
        });
      }
    }
  }

  // Whether any cell has: an open face and liquid.
  bool hasPressure(const std::vector<double>& liquid_distance) const {
    for (int k = 0; k < l_.n[2]; ++k) {
      for (int j = 0; j < l_.n[1]; ++j) {
        for (int i = 0; i < l_.n[0]; ++i) {
          const auto c = l_.index(i, j, k);
          bool open = false;
          if (liquid_distance[c] < 0.0) forEachOpen(c, [&](std::ptrdiff_t) { open = true; });
          if (open) return true;
        }
      }
    }
    return false;
  }

  const Lattice& l_;
  const FaceField<double>& fluid_;
  std::vector<const StickingPart*> closed_;
  std::vector<std::uint8_t> state_;
  std::ptrdiff_t shut_ = 0;  // cells
};

}  // namespace

void reopenNarrowGaps(const Lattice& l, const std::vector<double>& liquid_distance, FaceField<double>& fluid,
                      std::vector<StickingPart>& parts) {
  Gaps gaps(l, fluid, parts);
  if (!gaps.anyClosed()) return;
  gaps.findCutOff(liquid_distance);
  std::vector<StickingPart> kept, reopened;
  for (const StickingPart& p : parts) (gaps.isCutOff(p) ? reopened : kept).push_back(p);
  for (const StickingPart& p : reopened) fluid[p.axis][p.face] = p.part;
  parts.swap(kept);
}

}  // namespace monolith
