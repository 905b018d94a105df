#pragma once
// Long arrays of one value, and copies of long arrays, written by all threads: through pointers, or a field of bytes,
// which may be anything's, is written byte by byte.

#include <cstddef>
#include <vector>

namespace monolith {

template <class Value>
void assignField(std::size_t size, Value value, std::vector<Value>& v) {
  v.resize(size);
  Value* to = v.data();
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < size; ++i) to[i] = value;
}

template <class Value>
void assignZero(std::size_t size, std::vector<Value>& v) {
  assignField(size, Value(0), v);
}

template <class Value>
void copyField(const std::vector<Value>& from, std::vector<Value>& to) {
  const std::size_t size = from.size();
  to.resize(size);
  const Value* in = from.data();
  Value* out = to.data();
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < size; ++i) out[i] = in[i];
}

}  // namespace monolith
