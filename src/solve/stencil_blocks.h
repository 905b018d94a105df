#pragma once
// A stencil operator on a lattice, compressed: x-rows are cut into blocks of kLanes unknowns, and each block names a
// pattern, the coefficients of its lanes. Blocks that look alike - everything away from boundaries, and most of what
// lies along walls - share one pattern, so that the coefficients of a level stay in the first cache and only the fields
// are streamed. Blocks without any unknown are left out; lanes without one have coefficients of zero.
//
// Coefficient q of lane i of pattern p: values[(p * Count + q) * kLanes + i].

#include <omp.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <unordered_map>
#include <vector>

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
  std::size_t patterns() const { return values_.size() / (Count * kLanes); }
  std::size_t bytes() const { return blocks_.size() * sizeof(Block) + values_.size() * sizeof(Real); }

  // The same in another precision.
  template <class To>
  StencilBlocks<To, Count> converted() const {
    StencilBlocks<To, Count> out;
    out.blocks_.resize(blocks_.size());
    std::memcpy(out.blocks_.data(), blocks_.data(), blocks_.size() * sizeof(Block));
    out.segments_.resize(segments_.size());
    std::memcpy(out.segments_.data(), segments_.data(), segments_.size() * sizeof(Segment));
    out.values_.resize(values_.size());
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < values_.size(); ++i) out.values_[i] = static_cast<To>(values_[i]);
    out.lattice_ = lattice_;
    out.anew_ = anew_;
    out.build_ = build_;
    for (const Lost& lost : lost_) out.lost_.push_back({lost.component, lost.place});
    return out;
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

  // What a build makes of one plane of the lattice.
  struct Plane {
    std::vector<std::vector<Block>> blocks;  // by components
    std::vector<std::int32_t> row_ends;      // blocks up to here, of a component's rows
    std::vector<Real> values;
    std::vector<std::int32_t> origin;  // of each pattern among the last build's; -1: none

    std::int32_t add(const Real* pattern, std::int32_t from) {
      values.insert(values.end(), pattern, pattern + kSize);
      origin.push_back(from);
      return static_cast<std::int32_t>(origin.size()) - 1;
    }
  };
  // What the last build has left.
  struct Last {
    std::vector<Block> blocks;
    std::vector<Real> values;
    std::vector<std::int32_t> row_begin;

    std::size_t patterns() const { return values.size() / kSize; }
  };
  template <class FillRow>
  void buildPlane(int k, const std::vector<int>& first, FillRow&& fill, const SteadyRows* kept, const Last& before,
                  Plane& plane) const;
  void merge(std::vector<Plane>& planes, int components, std::size_t patterns_before);
  void findLost(int components, const Last& before);

  // Some of a pattern's words tell most patterns apart; which are the same is seen from all of them.
  struct PatternHash {
    std::size_t operator()(std::string_view text) const {
      constexpr std::size_t kStride = 7 * sizeof(std::uint64_t);
      std::uint64_t sum = 0;
      for (std::size_t at = 0; at + sizeof(std::uint64_t) <= text.size(); at += kStride) {
        std::uint64_t word;
        std::memcpy(&word, text.data() + at, sizeof(word));
        sum = (sum ^ word) * 0x9E3779B97F4A7C15u;
        sum ^= sum >> 29;
      }
      return sum;
    }
  };

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
  std::vector<Real> values_;
  std::vector<std::int32_t> row_begin_;  // in blocks_, of every row; one more at the end
  long generation_ = -2;                 // of the steady rows that it was built with
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
  const bool keeps = !anew_ && wouldKeep(steady);
  Last last{std::move(blocks_), std::move(values_), std::move(row_begin_)};
  lattice_ = l;
  ++build_;
  generation_ = steady != nullptr ? steady->generation() : -2;
  std::vector<Plane> planes(l.faceEnd(2));
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) buildPlane(k, first, fill, keeps ? steady : nullptr, last, planes[k]);
  const std::size_t patterns_before = last.patterns();
  last.values = {};
  merge(planes, components, patterns_before);
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
        const auto same = [&](std::int32_t pattern) {
          return pattern >= 0 &&
                 std::memcmp(plane.values.data() + pattern * kSize, candidate.data(), kSize * sizeof(Real)) == 0;
        };
        std::int32_t pattern = same(above[block]) ? above[block] : same(last) ? last : -1;
        if (pattern < 0) pattern = plane.add(candidate.data(), -1);
        above[block] = last = pattern;
        blocks.push_back({static_cast<std::int32_t>(start + block * kLanes), pattern});
      }
    }
    plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
  }
}

// One after the other, so that patterns are numbered the same way on any number of threads. Uses up the planes.
template <class Real, int Count>
void StencilBlocks<Real, Count>::merge(std::vector<Plane>& planes, int components, std::size_t patterns_before) {
  const int rows = lattice_.faceEnd(1);
  blocks_.clear();
  segments_.clear();
  values_.clear();
  std::size_t most = 0;
  for (const Plane& plane : planes) most += plane.values.size();
  values_.reserve(most);
  row_begin_.assign(1, 0);
  std::unordered_map<std::string_view, std::int32_t, PatternHash> known;
  std::vector<std::int32_t> number, renumbered(patterns_before, -1);
  for (Plane& plane : planes) {
    number.clear();
    for (std::size_t p = 0; p < plane.origin.size(); ++p) {
      const std::int32_t origin = plane.origin[p];
      std::int32_t found = origin < 0 ? -1 : renumbered[origin];
      if (found < 0) {
        const Real* values = plane.values.data() + p * kSize;
        const std::string_view text(reinterpret_cast<const char*>(values), kSize * sizeof(Real));
        const auto entry = known.find(text);
        if (entry != known.end()) {
          found = entry->second;
        } else {
          found = static_cast<std::int32_t>(values_.size() / kSize);
          values_.insert(values_.end(), values, values + kSize);  // there is room: none moves, and the key stays
          known.emplace(std::string_view(reinterpret_cast<const char*>(values_.data() + found * kSize), text.size()),
                        found);
        }
        if (origin >= 0) renumbered[origin] = found;
      }
      number.push_back(found);
    }
    for (int component = 0; component < components; ++component) {
      const auto begin = static_cast<std::int32_t>(blocks_.size());
      for (const Block& block : plane.blocks[component]) blocks_.push_back({block.place, number[block.pattern]});
      for (int j = 0; j < rows; ++j) row_begin_.push_back(begin + plane.row_ends[component * rows + j]);
      const auto end = static_cast<std::int32_t>(blocks_.size());
      if (end > begin) segments_.push_back({component, begin, end});
    }
    plane = {};
  }
}

// Both builds in the same order: by rows, and along them.
template <class Real, int Count>
void StencilBlocks<Real, Count>::findLost(int components, const Last& before) {
  lost_.clear();
  if (anew_) return;
  const int rows = lattice_.faceEnd(1);
  for (std::size_t at = 0; at + 1 < row_begin_.size(); ++at) {
    auto now = row_begin_[at];
    for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
      while (now < row_begin_[at + 1] && blocks_[now].place < before.blocks[b].place) ++now;
      if (now < row_begin_[at + 1] && blocks_[now].place == before.blocks[b].place) continue;
      lost_.push_back({static_cast<std::int32_t>(at / rows % components), before.blocks[b].place});
    }
  }
}

}  // namespace monolith
