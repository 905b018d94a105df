#pragma once
// Numbers things in the order in which they are added, by hash and open addressing: nothing is allocated for each of
// them, unlike in std::unordered_map.

#include <cstdint>
#include <vector>

namespace monolith {

class IndexTable {
 public:
  // For about so many things; it grows if there are more.
  explicit IndexTable(std::size_t expected = 0) {
    std::size_t size = kFirstSlots;
    while (size < 2 * expected) size *= 2;
    slots_.assign(size, -1);
  }

  // The number of the thing of this hash for which isSame(number) holds; -1: there is none.
  template <class IsSame>
  std::int32_t find(std::uint64_t hash, IsSame&& isSame) const {
    for (std::size_t slot = hash & mask(); slots_[slot] >= 0; slot = (slot + 1) & mask()) {
      const std::int32_t number = slots_[slot];
      if (hashes_[number] == hash && isSame(number)) return number;
    }
    return -1;
  }

  // Numbers one more.
  void add(std::uint64_t hash) {
    hashes_.push_back(hash);
    if (2 * hashes_.size() <= slots_.size()) {
      place(count() - 1);
      return;
    }
    slots_.assign(2 * slots_.size(), -1);
    for (std::int32_t i = 0; i < count(); ++i) place(i);
  }

  std::int32_t count() const { return static_cast<std::int32_t>(hashes_.size()); }

 private:
  static constexpr std::size_t kFirstSlots = 64;

  std::size_t mask() const { return slots_.size() - 1; }
  void place(std::int32_t number) {
    std::size_t slot = hashes_[number] & mask();
    while (slots_[slot] >= 0) slot = (slot + 1) & mask();
    slots_[slot] = number;
  }

  std::vector<std::int32_t> slots_;  // -1: free
  std::vector<std::uint64_t> hashes_;
};

}  // namespace monolith
