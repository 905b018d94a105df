#pragma once
// A long vector in a little more than two bytes an entry: entries are whole numbers of 16 bits times the scale of their
// group, and so off by 1.6e-5 of the group's largest at most. For vectors of which it does not matter what exactly they
// are, as long as everyone sees the same: directions of flexible GMRES.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solve/blocked_sum.h"

namespace monolith {

class RoundedVector {
 public:
  // Keeps the entries of x in these parts, and rounds x to what it keeps; where an entry is no number, so are those of
  // its group. Entries from `rest` on, the start of a part, differ too much from their neighbours for that, and are
  // few: they are kept as they are. 10 bytes and 5 flops an entry: bound by memory.
  void take(const Parts& parts, std::ptrdiff_t rest, std::vector<float>& x);

  // y += a times what was taken of a part; y: where its first entry is.
  void addTo(const Parts& parts, std::size_t part, double a, double* y) const;

  // Of an entry.
  static constexpr double bytes() { return sizeof(std::int16_t) + sizeof(float) / static_cast<double>(kGroup); }

 private:
  static constexpr std::ptrdiff_t kGroup = 32;  // entries, one after the other

  std::vector<std::ptrdiff_t> first_;  // group of each part that is rounded
  std::vector<std::int16_t> values_;   // kGroup for each group
  std::vector<float> scales_;          // of each group
  std::vector<float> rest_;
};

}  // namespace monolith
