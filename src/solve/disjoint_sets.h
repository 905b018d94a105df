#pragma once
// Sets of numbers from 0 on that are joined step by step (union-find with path halving).

#include <algorithm>
#include <numeric>
#include <vector>

namespace monolith {

class DisjointSets {
 public:
  explicit DisjointSets(int count = 0) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int count() const { return static_cast<int>(parent_.size()); }
  // The least of a set stands for it, whatever the order in which they were joined.
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace monolith
