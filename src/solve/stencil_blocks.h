#pragma once
// A stencil operator on a lattice, compressed: x-rows are cut into blocks of kLanes unknowns, and each block names a
// pattern, the coefficients of its lanes. Blocks that look alike - everything away from boundaries, and most of what
// lies along walls - share one pattern, so that the coefficients of a level stay in the first cache and only the fields
// are streamed. Blocks without any unknown are left out; lanes without one have coefficients of zero.
//
// Coefficient q of lane i of pattern p: values[(p * Count + q) * kLanes + i].

#include <omp.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "solve/index_table.h"
#include "solve/lattice.h"
#include "solve/steady_rows.h"
#include "solve/whole_fields.h"

namespace monolith {

// Fewer blocks than this are not worth waking a second thread for.
constexpr std::ptrdiff_t kBlocksWorthSharing = 500;

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

  // Those that have blocks.
  Planes planes() const { return planes_; }
  std::size_t blocks() const { return blocks_.size(); }
  std::size_t lanes() const { return blocks_.size() * kLanes; }
  std::size_t patterns() const { return values_.size() / (Count * kLanes); }

  // The same in another precision.
  template <class To>
  void convertTo(StencilBlocks<To, Count>& out) const {
    out.blocks_.resize(blocks_.size());
    std::memcpy(out.blocks_.data(), blocks_.data(), blocks_.size() * sizeof(Block));
    out.segments_.resize(segments_.size());
    std::memcpy(out.segments_.data(), segments_.data(), segments_.size() * sizeof(Segment));
    out.values_.resize(values_.size());
#pragma omp parallel for simd schedule(static)
    for (Eigen::Index i = 0; i < values_.size(); ++i) out.values_[i] = static_cast<To>(values_[i]);
    out.lattice_ = lattice_;
    out.planes_ = planes_;
    out.anew_ = anew_;
    out.build_ = build_;
    out.lost_.clear();
    for (const Lost& lost : lost_) out.lost_.push_back({lost.component, lost.place});
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
  using Values = Eigen::Array<Real, Eigen::Dynamic, 1>;  // resized, it is not written by one thread first

  // What a build makes of one plane of the lattice.
  struct Plane {
    std::vector<std::vector<Block>> blocks;  // by components
    std::vector<std::int32_t> row_ends;      // blocks up to here, of a component's rows
    std::vector<Real> values;
    std::vector<std::int32_t> origin;  // of each pattern among the last build's; -1: none
    std::vector<std::uint64_t> hash;   // of each pattern
    std::vector<std::int32_t> number;  // of each pattern among all planes'

    // All but its memory.
    void clear() {
      for (auto& of_component : blocks) of_component.clear();
      row_ends.clear();
      values.clear();
      origin.clear();
      hash.clear();
      number.clear();
    }
    std::int32_t add(const Real* pattern, std::int32_t from) {
      values.insert(values.end(), pattern, pattern + kSize);
      origin.push_back(from);
      hash.push_back(hashOf(pattern));
      return static_cast<std::int32_t>(origin.size()) - 1;
    }
  };
  // What the last build has left.
  struct Last {
    std::vector<Block> blocks;
    Values values;
    std::vector<std::int32_t> row_begin;

    std::size_t patterns() const { return values.size() / kSize; }
  };
  template <class FillRow>
  void buildPlane(int k, const std::vector<int>& first, FillRow&& fill, const SteadyRows* kept, const Last& before,
                  Plane& plane) const;
  std::int32_t numberPatterns(std::size_t patterns_before);
  void merge(int components, std::int32_t patterns);
  void findLost(int components, const Last& before);

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
  Planes planes_;
  Values values_;
  std::vector<std::int32_t> row_begin_;  // in blocks_, of every row; one more at the end
  long generation_ = kNoGeneration;      // of the steady rows that it was built with
  Lattice lattice_;
  bool anew_ = true;  // the last build was the first on its lattice
  long build_ = 0;
  std::vector<Lost> lost_;       // blocks that the build before had
  std::vector<Plane> building_;  // planes, of use within a build only, kept for their memory
};

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::build(const Lattice& l, const std::vector<int>& first, FillRow&& fill,
                                       const SteadyRows* steady) {
  const int components = static_cast<int>(first.size());
  anew_ = build_ == 0 || lattice_.n != l.n || lattice_.periodic != l.periodic;
  const bool keeps = !anew_ && wouldKeep(steady);
  const Last last{std::move(blocks_), std::move(values_), std::move(row_begin_)};
  lattice_ = l;
  ++build_;
  generation_ = steady != nullptr ? steady->generation() : kNoGeneration;
  building_.resize(l.faceEnd(2));
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) buildPlane(k, first, fill, keeps ? steady : nullptr, last, building_[k]);
  merge(components, numberPatterns(last.patterns()));
  findLost(components, last);
}

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::buildPlane(int k, const std::vector<int>& first, FillRow&& fill,
                                            const SteadyRows* kept, const Last& before, Plane& plane) const {
  const Lattice& l = lattice_;
  const int components = static_cast<int>(first.size());
  const int row_blocks = (l.n[0] + kLanes - 1) / kLanes;
  const int rows = l.faceEnd(1);
  plane.clear();
  plane.blocks.resize(components);
  Row row;
  for (auto& r : row) r.resize(row_blocks * kLanes);
  std::vector<Real> candidate(kSize);
  // The last build's patterns, in this plane.
  std::vector<std::int32_t> here(kept != nullptr ? before.patterns() : 0, -1);
  for (int component = 0; component < components; ++component) {
    std::vector<Block>& blocks = plane.blocks[component];
    std::vector<std::int32_t> above(row_blocks, -1);  // patterns of the row before
    std::int32_t last = -1;
    for (int j = 0; j < rows; ++j) {
      if (j > 0) plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
      const auto start = l.index(first[component], j, k);
      if (kept != nullptr && kept->steady(j, k)) {
        const std::size_t at = (static_cast<std::size_t>(k) * components + component) * rows + j;
        for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
          const Block& block = before.blocks[b];
          std::int32_t& pattern = here[block.pattern];
          if (pattern < 0) pattern = plane.add(before.values.data() + block.pattern * kSize, block.pattern);
          above[(block.place - start) / kLanes] = last = pattern;
          blocks.push_back({block.place, pattern});
        }
        continue;
      }
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
        const auto fits = [&](std::int32_t pattern) {
          return pattern >= 0 && same(plane.values.data() + pattern * kSize, candidate.data());
        };
        std::int32_t pattern = fits(above[block]) ? above[block] : fits(last) ? last : -1;
        if (pattern < 0) pattern = plane.add(candidate.data(), -1);
        above[block] = last = pattern;
        blocks.push_back({static_cast<std::int32_t>(start + block * kLanes), pattern});
      }
    }
    plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
  }
}

// One after the other, so that patterns are numbered the same way on any number of threads. Returns how many there are.
template <class Real, int Count>
std::int32_t StencilBlocks<Real, Count>::numberPatterns(std::size_t patterns_before) {
  std::size_t most = 0;
  for (const Plane& plane : building_) most += plane.origin.size();
  IndexTable table(most);
  std::vector<std::int32_t> renumbered(patterns_before, -1);
  std::vector<std::pair<const Real*, std::uint64_t>> known;
  for (Plane& plane : building_) {
    plane.number.resize(plane.origin.size());
    for (std::size_t p = 0; p < plane.origin.size(); ++p) {
      const std::int32_t origin = plane.origin[p];
      std::int32_t found = origin < 0 ? -1 : renumbered[origin];
      if (found < 0) {
        const Real* values = plane.values.data() + p * kSize;
        const std::uint64_t hash = plane.hash[p];
        found =
            table.number(hash, [&](std::int32_t i) { return known[i].second == hash && same(known[i].first, values); });
        if (found == static_cast<std::int32_t>(known.size())) known.emplace_back(values, hash);
        if (origin >= 0) renumbered[origin] = found;
      }
      plane.number[p] = found;
    }
  }
  return table.count();
}

template <class Real, int Count>
void StencilBlocks<Real, Count>::merge(int components, std::int32_t patterns) {
  const int rows = lattice_.faceEnd(1);
  values_.resize(patterns * kSize);
  // Where each plane's part begins, and which patterns it is the first to have.
  std::vector<std::int32_t> first_block, first_pattern;
  segments_.clear();
  planes_ = {};
  std::int32_t count = 0, known = 0;
  for (std::size_t k = 0; k < building_.size(); ++k) {
    const Plane& plane = building_[k];
    first_block.push_back(count);
    first_pattern.push_back(known);
    for (int component = 0; component < components; ++component) {
      const auto size = static_cast<std::int32_t>(plane.blocks[component].size());
      if (size > 0) segments_.push_back({component, count, count + size});
      count += size;
    }
    if (count > first_block.back()) {
      if (planes_.end == 0) planes_.first = static_cast<int>(k);
      planes_.end = static_cast<int>(k) + 1;
    }
    for (const std::int32_t number : plane.number) known = std::max(known, number + 1);
  }
  blocks_.resize(count);
  row_begin_.resize(building_.size() * components * rows + 1);
  row_begin_[0] = 0;
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (std::size_t k = 0; k < building_.size(); ++k) {
    Plane& plane = building_[k];
    std::int32_t begin = first_block[k], next = first_pattern[k];
    for (std::size_t p = 0; p < plane.number.size(); ++p) {
      if (plane.number[p] != next) continue;
      std::copy_n(plane.values.data() + p * kSize, kSize, values_.data() + next * kSize);
      ++next;
    }
    for (int component = 0; component < components; ++component) {
      for (int j = 0; j < rows; ++j) {
        row_begin_[(k * components + component) * rows + j + 1] = begin + plane.row_ends[component * rows + j];
      }
      for (const Block& block : plane.blocks[component]) blocks_[begin++] = {block.place, plane.number[block.pattern]};
    }
  }
}

// Both builds in the same order: by rows, and along them.
template <class Real, int Count>
void StencilBlocks<Real, Count>::findLost(int components, const Last& before) {
  lost_.clear();
  if (anew_) return;
  const int rows = lattice_.faceEnd(1);
  const auto plane_rows = static_cast<std::size_t>(components) * rows;
  std::vector<std::vector<Lost>> planes(lattice_.faceEnd(2));
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (std::size_t k = 0; k < planes.size(); ++k) {
    for (std::size_t at = k * plane_rows; at < (k + 1) * plane_rows; ++at) {
      auto now = row_begin_[at];
      for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
        while (now < row_begin_[at + 1] && blocks_[now].place < before.blocks[b].place) ++now;
        if (now < row_begin_[at + 1] && blocks_[now].place == before.blocks[b].place) continue;
        planes[k].push_back({static_cast<std::int32_t>(at / rows % components), before.blocks[b].place});
      }
    }
  }
  for (const auto& plane : planes) lost_.insert(lost_.end(), plane.begin(), plane.end());
}

}  // namespace monolith
