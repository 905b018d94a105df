#pragma once
// A stencil operator on a lattice, compressed: x-rows are cut into blocks of kLanes unknowns, and each block names a
// pattern, the coefficients of its lanes. Blocks that look alike - everything away from boundaries, and most of what
// lies along walls - share one pattern, so that the coefficients of a level stay in the first cache and only the fields
// are streamed. Blocks without any unknown are left out; lanes without one have coefficients of zero.
//
// Coefficient q of lane i of pattern p: values[(p * Count + q) * kLanes + i]. A pattern keeps its number as long as
// there are blocks of it: of rows that are steady nothing is written but the blocks.

#include <omp.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "solve/index_table.h"
#include "solve/lattice.h"
#include "solve/steady_rows.h"
#include "solve/whole_fields.h"

namespace monolith {

// Fewer blocks, or patterns, than this are not worth waking a second thread for.
constexpr std::ptrdiff_t kBlocksWorthSharing = 500, kPatternsWorthSharing = 200;

template <class Real, int Count>
class StencilBlocks {
 public:
  static constexpr int kCount = Count;
  using Row = std::array<std::vector<Real>, Count>;

  // fill(component, row, width, out) writes the coefficients of `width` lanes from index `row` on, all zero: no unknown;
  // or returns false, then there is none in the row. `first[component]`: index along x of the first lane of a row.
  // It is not called for rows that are steady since the last build, if that was of the generation before.
  template <class FillRow>
  void build(const Lattice& l, const std::vector<int>& first, FillRow&& fill, const SteadyRows* steady = nullptr);

  // Kernels write blocks only: a field is zero elsewhere if it was before. One that has followed every build, the last of
  // them `build`, needs zeros just in the blocks that are lost since: clears those of a component, else all of it.
  template <class Value>
  void clear(int component, long build, std::vector<Value>& field) const {
    if (!follows(build) || field.size() != lattice_.size) {
      assignZero(lattice_.size, field);
      return;
    }
    for (const Lost& lost : lost_) {
      if (lost.component == component) std::fill_n(field.begin() + lost.place, kLanes, Value(0));
    }
  }
  // Whether the blocks are those of `build` but for lost() and new ones.
  bool follows(long build) const { return !anew_ && build + 1 == build_; }
  long build() const { return build_; }
  struct Lost {
    std::int32_t component, place;
  };
  const std::vector<Lost>& lost() const { return lost_; }

  // The next build makes all rows anew, steady or not.
  void distrust() { generation_ = kNoGeneration; }
  // Whether a build with these would leave steady rows as they are.
  bool wouldKeep(const SteadyRows* steady) const { return steady != nullptr && steady->isSuccessor(generation_); }

  // f(component, place, values): for every block, shared among threads; f must write its own lanes only.
  template <class BlockFunction>
  void forEach(BlockFunction&& f) const {
    const auto total = static_cast<std::ptrdiff_t>(blocks_.size());
    if (total < kBlocksWorthSharing) {
      run(0, total, f);
      return;
    }
#pragma omp parallel
    {
      const std::ptrdiff_t threads = omp_get_num_threads(), mine = omp_get_thread_num();
      run(total * mine / threads, total * (mine + 1) / threads, f);
    }
  }

  std::size_t blocks() const { return blocks_.size(); }
  std::size_t lanes() const { return blocks_.size() * kLanes; }
  std::size_t patterns() const { return hash_.size(); }

  // The same in another precision; cheap if it was made from the build before the last.
  template <class From>
  void convert(const StencilBlocks<From, Count>& from) {
    const bool follows = !from.anew_ && build_ + 1 == from.build_;
    blocks_.resize(from.blocks_.size());
    std::memcpy(blocks_.data(), from.blocks_.data(), blocks_.size() * sizeof(Block));
    segments_.clear();
    for (const auto& s : from.segments_) segments_.push_back({s.component, s.begin, s.end});
    lost_.clear();
    for (const auto& lost : from.lost_) lost_.push_back({lost.component, lost.place});
    lattice_ = from.lattice_;
    anew_ = from.anew_;
    build_ = from.build_;
    values_.conservativeResize(from.values_.size());
    const auto take = [&](std::ptrdiff_t p) {
      for (std::size_t i = p * kSize; i < (p + 1) * kSize; ++i) values_[i] = static_cast<Real>(from.values_[i]);
    };
    const auto count = static_cast<std::ptrdiff_t>(follows ? from.fresh_.size() : from.patterns());
#pragma omp parallel for schedule(static) if (count >= kPatternsWorthSharing)
    for (std::ptrdiff_t p = 0; p < count; ++p) take(follows ? from.fresh_[p] : p);
  }

 private:
  template <class, int>
  friend class StencilBlocks;

  struct Block {
    std::int32_t place, pattern;
  };
  struct Segment {
    std::int32_t component, begin, end;
  };
  static constexpr std::size_t kSize = Count * kLanes;
  static constexpr long kNoGeneration = -2;
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::min();  // of patterns
  using Values = Eigen::Array<Real, Eigen::Dynamic, 1>;  // resized, it is not written by one thread first

  // What a build makes of one plane of the lattice. Patterns that the last build did not have are numbered from -1
  // down.
  struct Plane {
    std::vector<std::vector<Block>> blocks;  // by components
    std::vector<std::int32_t> row_ends;      // blocks up to here, of a component's rows
    std::vector<Real> values;                // of its new patterns
    std::vector<std::uint64_t> hash;
    std::vector<std::int32_t> number;  // of each of them among all

    std::int32_t add(const Real* pattern, std::uint64_t its_hash) {
      values.insert(values.end(), pattern, pattern + kSize);
      hash.push_back(its_hash);
      return -static_cast<std::int32_t>(hash.size());
    }
    const Real* at(std::int32_t pattern) const {
      return values.data() - (pattern + 1) * static_cast<std::ptrdiff_t>(kSize);
    }
    std::int32_t numberOf(std::int32_t pattern) const { return pattern < 0 ? number[-pattern - 1] : pattern; }
  };
  // What the last build has left.
  struct Last {
    std::vector<Block> blocks;
    std::vector<std::int32_t> row_begin;
  };
  template <class FillRow>
  void buildPlane(int k, const std::vector<int>& first, FillRow&& fill, const SteadyRows* kept, const IndexTable& known,
                  const Last& before, Plane& plane) const;
  void numberPatterns(std::vector<Plane>& planes, IndexTable& known);
  void merge(std::vector<Plane>& planes, int components);
  void findLost(int components, const SteadyRows* kept, const Last& before);

  // Some of a pattern's words tell most patterns apart; which are the same is seen from all of them.
  static std::uint64_t hashOf(const Real* pattern) {
    constexpr std::size_t kWord = sizeof(std::uint64_t), kStride = 7 * kWord;
    const char* bytes = reinterpret_cast<const char*>(pattern);
    std::uint64_t sum = 0;
    for (std::size_t at = 0; at + kWord <= kSize * sizeof(Real); at += kStride) {
      std::uint64_t word;
      std::memcpy(&word, bytes + at, kWord);
      sum = (sum ^ word) * 0x9E3779B97F4A7C15u;
      sum ^= sum >> 29;
    }
    return sum;
  }
  static bool same(const Real* a, const Real* b) { return std::memcmp(a, b, kSize * sizeof(Real)) == 0; }

  template <class BlockFunction>
  void run(std::ptrdiff_t begin, std::ptrdiff_t end, BlockFunction&& f) const {
    for (const Segment& segment : segments_) {
      const auto last = std::min<std::ptrdiff_t>(end, segment.end);
      for (auto i = std::max<std::ptrdiff_t>(begin, segment.begin); i < last; ++i) {
        f(segment.component, static_cast<std::ptrdiff_t>(blocks_[i].place),
          values_.data() + blocks_[i].pattern * kSize);
      }
    }
  }

  std::vector<Block> blocks_;            // by planes, within them by components, then by rows
  std::vector<Segment> segments_;        // blocks of one component in one plane
  Values values_;                        // of patterns without blocks, too
  std::vector<std::uint64_t> hash_;      // of each pattern
  std::vector<std::int32_t> fresh_;      // patterns that the last build wrote
  std::vector<std::int32_t> row_begin_;  // in blocks_, of every row; one more at the end
  long generation_ = kNoGeneration;      // of the steady rows that it was built with
  Lattice lattice_;
  bool anew_ = true;  // the last build was the first on its lattice
  long build_ = 0;
  std::vector<Lost> lost_;  // blocks that the build before had
};

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::build(const Lattice& l, const std::vector<int>& first, FillRow&& fill,
                                       const SteadyRows* steady) {
  const int components = static_cast<int>(first.size());
  anew_ = build_ == 0 || lattice_.n != l.n || lattice_.periodic != l.periodic;
  const SteadyRows* kept = !anew_ && wouldKeep(steady) ? steady : nullptr;
  const Last last{std::move(blocks_), std::move(row_begin_)};
  lattice_ = l;
  ++build_;
  generation_ = steady != nullptr ? steady->generation() : kNoGeneration;
  if (anew_) hash_.clear();
  IndexTable known(hash_.size());
  for (const std::uint64_t hash : hash_) known.add(hash);
  std::vector<Plane> planes(l.faceEnd(2));
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) buildPlane(k, first, fill, kept, known, last, planes[k]);
  numberPatterns(planes, known);
  merge(planes, components);
  findLost(components, kept, last);
}

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::buildPlane(int k, const std::vector<int>& first, FillRow&& fill,
                                            const SteadyRows* kept, const IndexTable& known, const Last& before,
                                            Plane& plane) const {
  const Lattice& l = lattice_;
  const int components = static_cast<int>(first.size());
  const int row_blocks = (l.n[0] + kLanes - 1) / kLanes;
  const int rows = l.faceEnd(1);
  plane.blocks.resize(components);
  Row row;
  for (auto& r : row) r.resize(row_blocks * kLanes);
  std::vector<Real> candidate(kSize);
  for (int component = 0; component < components; ++component) {
    std::vector<Block>& blocks = plane.blocks[component];
    // Patterns of the row that was made last, and of the block before: likely to be the next ones, too.
    std::vector<std::int32_t> above(row_blocks, kNone);
    std::int32_t last = kNone;
    for (int j = 0; j < rows; ++j) {
      if (j > 0) plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
      if (kept != nullptr && kept->steady(j, k)) {
        const std::size_t at = (static_cast<std::size_t>(k) * components + component) * rows + j;
        blocks.insert(blocks.end(), before.blocks.begin() + before.row_begin[at],
                      before.blocks.begin() + before.row_begin[at + 1]);
        continue;
      }
      const auto start = l.index(first[component], j, k);
      if (!fill(component, start, row_blocks * kLanes, row)) continue;
      // Lanes beyond the row; along a periodic axis they hold images.
      for (int lane = l.faceEnd(0) - first[component]; lane < row_blocks * kLanes; ++lane) {
        for (auto& r : row) r[lane] = Real(0);
      }
      for (int block = 0; block < row_blocks; ++block) {
        for (int q = 0; q < Count; ++q) {
          std::copy_n(row[q].data() + block * kLanes, kLanes, candidate.data() + q * kLanes);
        }
        if (std::all_of(candidate.begin(), candidate.end(), [](Real value) { return value == Real(0); })) continue;
        const auto isIt = [&](std::int32_t pattern) {
          return same(pattern < 0 ? plane.at(pattern) : values_.data() + pattern * kSize, candidate.data());
        };
        std::int32_t pattern = kNone;
        if (above[block] != kNone && isIt(above[block])) {
          pattern = above[block];
        } else if (last != kNone && isIt(last)) {
          pattern = last;
        } else {
          const std::uint64_t hash = hashOf(candidate.data());
          const std::int32_t found = known.find(hash, isIt);
          pattern = found >= 0 ? found : plane.add(candidate.data(), hash);
        }
        above[block] = last = pattern;
        blocks.push_back({static_cast<std::int32_t>(start + block * kLanes), pattern});
      }
    }
    plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
  }
}

// New patterns take the places of those that are no longer used, plane by plane, so that they are numbered the same way
// on any number of threads.
template <class Real, int Count>
void StencilBlocks<Real, Count>::numberPatterns(std::vector<Plane>& planes, IndexTable& known) {
  std::vector<char> used(hash_.size(), 0);
  for (const Plane& plane : planes) {
    for (const auto& blocks : plane.blocks) {
      for (const Block& block : blocks) {
        if (block.pattern >= 0) used[block.pattern] = 1;
      }
    }
  }
  const auto old = static_cast<std::int32_t>(hash_.size());
  std::int32_t next = 0;  // no place before it is free
  fresh_.clear();
  std::vector<const Real*> source;
  std::vector<std::int32_t> place;  // of what `known` has numbered from `old` on
  for (Plane& plane : planes) {
    plane.number.resize(plane.hash.size());
    for (std::size_t p = 0; p < plane.hash.size(); ++p) {
      const Real* values = plane.values.data() + p * kSize;
      const std::uint64_t hash = plane.hash[p];
      const std::int32_t found =
          known.find(hash, [&](std::int32_t i) { return i >= old && same(source[i - old], values); });
      if (found >= 0) {
        plane.number[p] = place[found - old];
        continue;
      }
      known.add(hash);
      while (next < old && used[next]) ++next;
      if (next == static_cast<std::int32_t>(hash_.size())) hash_.push_back(hash);
      hash_[next] = hash;
      source.push_back(values);
      place.push_back(next);
      fresh_.push_back(next);
      plane.number[p] = next++;
    }
  }
  values_.conservativeResize(hash_.size() * kSize);
  const auto count = static_cast<std::ptrdiff_t>(fresh_.size());
#pragma omp parallel for schedule(static) if (count >= kPatternsWorthSharing)
  for (std::ptrdiff_t p = 0; p < count; ++p) std::copy_n(source[p], kSize, values_.data() + fresh_[p] * kSize);
}

// Uses up the planes.
template <class Real, int Count>
void StencilBlocks<Real, Count>::merge(std::vector<Plane>& planes, int components) {
  const int rows = lattice_.faceEnd(1);
  std::vector<std::int32_t> first_block;
  segments_.clear();
  std::int32_t count = 0;
  for (const Plane& plane : planes) {
    first_block.push_back(count);
    for (int component = 0; component < components; ++component) {
      const auto size = static_cast<std::int32_t>(plane.blocks[component].size());
      if (size > 0) segments_.push_back({component, count, count + size});
      count += size;
    }
  }
  blocks_.resize(count);
  row_begin_.resize(planes.size() * components * rows + 1);
  row_begin_[0] = 0;
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (std::size_t k = 0; k < planes.size(); ++k) {
    Plane& plane = planes[k];
    std::int32_t begin = first_block[k];
    for (int component = 0; component < components; ++component) {
      for (int j = 0; j < rows; ++j) {
        row_begin_[(k * components + component) * rows + j + 1] = begin + plane.row_ends[component * rows + j];
      }
      for (const Block& block : plane.blocks[component])
        blocks_[begin++] = {block.place, plane.numberOf(block.pattern)};
    }
    plane = {};
  }
}

// Both builds in the same order: by rows, and along them.
template <class Real, int Count>
void StencilBlocks<Real, Count>::findLost(int components, const SteadyRows* kept, const Last& before) {
  lost_.clear();
  if (anew_) return;
  const int rows = lattice_.faceEnd(1);
  for (std::size_t at = 0; at + 1 < row_begin_.size(); ++at) {
    const auto component = static_cast<std::int32_t>(at / rows % components);
    if (kept != nullptr && kept->steady(static_cast<int>(at % rows), static_cast<int>(at / rows / components)))
      continue;
    auto now = row_begin_[at];
    for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
      while (now < row_begin_[at + 1] && blocks_[now].place < before.blocks[b].place) ++now;
      if (now < row_begin_[at + 1] && blocks_[now].place == before.blocks[b].place) continue;
      lost_.push_back({component, before.blocks[b].place});
    }
  }
}

}  // namespace monolith
