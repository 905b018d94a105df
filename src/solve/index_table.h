#pragma once
// Numbers things in the order in which they first come, by hash and open addressing: nothing is allocated for each of
// them, unlike in std::unordered_map.

#include <cstdint>
#include <vector>

namespace monolith {

class IndexTable {
 public:
  // For that many different things at most.
  explicit IndexTable(std::size_t most) {
    std::size_t size = 64;
    while (size < 2 * most) size *= 2;
    slots_.assign(size, -1);
  }

  // The number of the one before for which isSame(number) holds, or count() if there is none: then it is a new one.
  template <class IsSame>
  std::int32_t number(std::uint64_t hash, IsSame&& isSame) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash & mask;
    while (slots_[slot] >= 0 && !isSame(slots_[slot])) slot = (slot + 1) & mask;
    if (slots_[slot] < 0) slots_[slot] = count_++;
    return slots_[slot];
  }
  std::int32_t count() const { return count_; }

 private:
  std::vector<std::int32_t> slots_;  // -1: free
  std::int32_t count_ = 0;
};

}  // namespace monolith
