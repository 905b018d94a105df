#pragma once
// Faces, or cells, that are not known but have a neighbour that is: where a field is continued to, layer by layer.

#include <array>
#include <cstdint>

#include "solve/lattice.h"
#include "solve/marked_entries.h"

namespace monolith {

// Calls f(index, {i, j, k}) for those of plane k, in order; known: 0 or 1, its halo filled. 7 loads of a byte each,
// whole vectors of them, and few are found: far cheaper than to ask face by face.
template <class Function>
void forEachNextToKnown(const Lattice& l, int k, const std::uint8_t* known, Function&& f) {
  const auto sy = l.stride[1], sz = l.stride[2];
  const auto begin = l.index(0, 0, k);
  const auto count = l.index(l.faceEnd(0) - 1, l.faceEnd(1) - 1, k) + 1 - begin;
  thread_local RowMarks next;
  std::uint8_t* out = next.start(count);
  const std::uint8_t* at = known + begin;
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint8_t around = at[i - 1] | at[i + 1] | at[i - sy] | at[i + sy] | at[i - sz] | at[i + sz];
    out[i] = static_cast<std::uint8_t>(around & (at[i] ^ 1));
  }
  next.forEach([&](std::ptrdiff_t i) {
    const std::array<int, 3> place = {static_cast<int>(i % sy), static_cast<int>(i / sy), k};
    if (place[0] < l.faceEnd(0)) f(begin + i, place);
  });
}

}  // namespace monolith
