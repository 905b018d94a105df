#pragma once
// Rows of a lattice (x-rows, called by j and k) around which nothing has changed since the last time: what was built
// for them still holds. A row is told by its kind: rows of one kind, other than kChanging, look the same whenever they
// are built with the same parameters.

#include <cstdint>
#include <vector>

#include "solve/lattice.h"

namespace monolith {

class SteadyRows {
 public:
  enum Kind : std::uint8_t { kChanging };  // others are the caller's

  // kinds: of the rows of cells, j fastest. Every update is a new generation.
  void update(const Lattice& lattice, const std::vector<std::uint8_t>& kinds, const std::vector<double>& parameters);
  // Nothing that was built before holds.
  void forget();

  // Rows of cells or faces.
  bool steady(int j, int k) const {
    return !steady_.empty() && steady_[j + static_cast<std::size_t>(lattice_.n[1] + 1) * k] != 0;
  }
  bool isSuccessor(long generation) const { return generation == generation_ || generation + 1 == generation_; }
  long generation() const { return generation_; }

 private:
  Lattice lattice_;
  std::vector<std::uint8_t> kinds_, steady_;
  std::vector<double> parameters_;
  bool known_ = false;
  long generation_ = 0;
};

}  // namespace monolith
