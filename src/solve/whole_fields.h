#pragma once
// Long arrays of one value, and copies of long arrays, written by all threads.

#include <cstddef>
#include <vector>

namespace monolith {

template <class Value>
void assignField(std::size_t size, Value value, std::vector<Value>& v) {
  v.resize(size);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < size; ++i) v[i] = value;
}

template <class Value>
void assignZero(std::size_t size, std::vector<Value>& v) {
  assignField(size, Value(0), v);
}

template <class Value>
void copyField(const std::vector<Value>& from, std::vector<Value>& to) {
  to.resize(from.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i];
}

}  // namespace monolith
