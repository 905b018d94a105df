#pragma once
// Sums over long arrays that give the same bits at any thread count: parts that do not depend on it, each summed by one
// thread, their sums added in order.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace monolith {

constexpr std::ptrdiff_t kSumBlock = 4096;

// Parts of a long array, each for one thread: those that hold unknowns, in the order in which threads share them.
struct Part {
  std::ptrdiff_t begin, end;
};
using Parts = std::vector<Part>;

// Cuts [begin, end) into equal parts, no longer than the blocks of sums.
inline void appendParts(std::ptrdiff_t begin, std::ptrdiff_t end, Parts& parts) {
  const std::ptrdiff_t size = end - begin, count = (size + kSumBlock - 1) / kSumBlock;
  for (std::ptrdiff_t p = 0; p < count; ++p)
    parts.push_back({begin + size * p / count, begin + size * (p + 1) / count});
}

// f(begin, end) -> Sum
template <class Sum, class BlockFunction>
Sum blockedSum(const Parts& parts, BlockFunction&& f) {
  std::vector<Sum> sums(parts.size());
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts.size(); ++p) sums[p] = f(parts[p].begin, parts[p].end);
  Sum total{};
  for (const Sum& sum : sums) total += sum;
  return total;
}

// The same for all of [0, size).
template <class Sum, class BlockFunction>
Sum blockedSum(std::ptrdiff_t size, BlockFunction&& f) {
  Parts parts;
  appendParts(0, size, parts);
  return blockedSum<Sum>(parts, f);
}

// Loops over long arrays take plain pointers, not what a lambda has captured: GCC 12 would gather the array's address
// anew for every lane.

constexpr std::ptrdiff_t kChunk = 512;  // terms of a sum in single precision

template <class Real>
double sumOfProducts(const Real* x, const Real* y, std::ptrdiff_t size) {
  double total = 0.0;
  for (std::ptrdiff_t begin = 0; begin < size; begin += kChunk) {
    const auto end = std::min(size, begin + kChunk);
    Real sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += x[i] * y[i];
    total += sum;
  }
  return total;
}

template <class Real>
double sumOf(const Real* x, std::ptrdiff_t size) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::ptrdiff_t i = 0; i < size; ++i) sum += static_cast<double>(x[i]);
  return sum;
}

inline double dot(const std::vector<double>& x, const std::vector<double>& y) {
  return blockedSum<double>(static_cast<std::ptrdiff_t>(x.size()), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return sumOfProducts(x.data() + begin, y.data() + begin, end - begin);
  });
}

}  // namespace monolith
