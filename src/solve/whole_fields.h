#pragma once
// Long arrays of zeros, and copies of long arrays, written by all threads.

#include <cstddef>
#include <vector>

namespace monolith {

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
