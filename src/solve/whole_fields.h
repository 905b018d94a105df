#pragma once
// Long arrays that all threads write: zeros, copies, and what is left unset for them.

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace monolith {

// Leaves entries unset that no value is given for: one that is written by all threads anyway is not written by one
// before.
template <class Value>
struct UnsetAllocator : std::allocator<Value> {
  template <class Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };
  template <class Other>
  void construct(Other* place) noexcept {
    ::new (static_cast<void*>(place)) Other;
  }
  template <class Other, class... Arguments>
  void construct(Other* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) Other(std::forward<Arguments>(arguments)...);
  }
};
template <class Value>
using UnsetVector = std::vector<Value, UnsetAllocator<Value>>;

template <class Value>
void assignZero(std::size_t size, std::vector<Value>& v) {
  v.resize(size);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < size; ++i) v[i] = Value(0);
}

template <class Value>
void copyField(const std::vector<Value>& from, std::vector<Value>& to) {
  to.resize(from.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i];
}

}  // namespace monolith
