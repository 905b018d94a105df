#pragma once
// Entries of a row that have something special, where most have nothing: a mark each, set by whole vectors, and then
// only those that are marked are looked at.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace monolith {

class RowMarks {
 public:
  // For `count` marks, none of them set: 0 or 1 each.
  std::uint8_t* start(std::ptrdiff_t count) {
    marks_.assign(static_cast<std::size_t>((count + kAtOnce - 1) / kAtOnce * kAtOnce), 0);
    return marks_.data();
  }

  // f(index) for those that are set, in order: each is one bit of a word, the lowest comes first.
  template <class Function>
  void forEach(Function&& f) const {
    const auto count = static_cast<std::ptrdiff_t>(marks_.size());
    for (std::ptrdiff_t first = 0; first < count; first += kAtOnce) {
      std::uint64_t any;
      std::memcpy(&any, marks_.data() + first, kAtOnce);
      for (; any != 0; any &= any - 1) f(first + __builtin_ctzll(any) / 8);
    }
  }

 private:
  static constexpr std::ptrdiff_t kAtOnce = 8;

  std::vector<std::uint8_t> marks_;
};

}  // namespace monolith
