#pragma once
// A field of a lattice to be kept for later, exactly: x-rows, halo and all, whose entries are all the same bits are
// kept as one of them. What rests or is far from everything takes next to nothing.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "solve/lattice.h"

namespace monolith {

template <class Value>
class PackedRows {
 public:
  // The field may be empty.
  PackedRows(const Lattice& lattice, const std::vector<Value>& field) : width_(lattice.stride[1]) {
    const std::size_t rows = field.size() / width_;
    std::size_t size = 0;
    uniform_.resize(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      const Value* values = field.data() + row * width_;
      uniform_[row] = std::memcmp(values, values + 1, (width_ - 1) * sizeof(Value)) == 0;
      size += uniform_[row] ? 1 : width_;
    }
    values_.reserve(size);
    for (std::size_t row = 0; row < rows; ++row) {
      const auto begin = field.begin() + static_cast<std::ptrdiff_t>(row * width_);
      values_.insert(values_.end(), begin, begin + static_cast<std::ptrdiff_t>(uniform_[row] ? 1 : width_));
    }
  }

  void unpack(std::vector<Value>& field) const {
    field.resize(uniform_.size() * width_);
    const Value* from = values_.data();
    for (std::size_t row = 0; row < uniform_.size(); ++row) {
      Value* to = field.data() + row * width_;
      if (uniform_[row]) {
        std::fill_n(to, width_, *from++);
      } else {
        std::copy_n(from, width_, to);
        from += width_;
      }
    }
  }

  std::size_t size() const { return values_.size(); }  // entries that are kept

 private:
  std::size_t width_;
  std::vector<bool> uniform_;
  std::vector<Value> values_;
};

}  // namespace monolith
