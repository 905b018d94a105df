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

#include "solve/assign_zero.h"
#include "solve/lattice.h"
#include "solve/steady_rows.h"

namespace monolith {

// Fewer blocks than this are not worth waking a second thread for.
constexpr std::ptrdiff_t kBlocksWorthSharing = 1000;

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

  // What is written for blocks is zero elsewhere only if it was before. A field that has followed every build needs zeros
  // just in the blocks that each of them lost: clears those of a component, or, if the field has not (`build`: the last one
  // that it has followed), all of it; `build` is the present one then.
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
    out.values_.assign(values_.begin(), values_.end());
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
  struct Plane {
    std::vector<std::vector<Block>> blocks;
    std::vector<std::int32_t> row_ends;  // blocks up to here, of a component's rows
    std::vector<Real> values;
    std::vector<std::int32_t> origin;  // of each pattern among the last build's; -1: none
  };
  const int components = static_cast<int>(first.size());
  const int row_blocks = (l.n[0] + kLanes - 1) / kLanes;
  const int rows = l.faceEnd(1);
  std::vector<Plane> planes(l.faceEnd(2));
  anew_ = build_ == 0 || lattice_.n != l.n || lattice_.periodic != l.periodic;
  lattice_ = l;
  ++build_;
  lost_.clear();
  const bool keeps = wouldKeep(steady) && row_begin_.size() == planes.size() * components * rows + 1;
  const std::vector<Block> last_blocks = std::move(blocks_);
  const std::vector<Real> last_values = std::move(values_);
  const std::vector<std::int32_t> last_begin = std::move(row_begin_);
  const std::size_t last_patterns = last_values.size() / kSize;
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) {
    Plane& plane = planes[k];
    plane.blocks.resize(components);
    Row row;
    for (auto& r : row) r.resize(row_blocks * kLanes);
    std::vector<Real> candidate(kSize);
    std::vector<std::int32_t> here(keeps ? last_patterns : 0, -1);  // patterns of the last build in this plane
    const auto add = [&](const Real* values, std::int32_t origin) {
      plane.values.insert(plane.values.end(), values, values + kSize);
      plane.origin.push_back(origin);
      return static_cast<std::int32_t>(plane.origin.size()) - 1;
    };
    for (int component = 0; component < components; ++component) {
      std::vector<std::int32_t> above(row_blocks, -1);  // patterns of the row before
      std::int32_t last = -1;
      for (int j = 0; j < rows; ++j) {
        std::vector<Block>& blocks = plane.blocks[component];
        if (j > 0) plane.row_ends.push_back(static_cast<std::int32_t>(blocks.size()));
        const auto start = l.index(first[component], j, k);
        if (keeps && steady->steady(j, k)) {
          const std::size_t at = (static_cast<std::size_t>(k) * components + component) * rows + j;
          for (auto b = last_begin[at]; b < last_begin[at + 1]; ++b) {
            const Block& block = last_blocks[b];
            std::int32_t& pattern = here[block.pattern];
            if (pattern < 0) pattern = add(last_values.data() + block.pattern * kSize, block.pattern);
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
          if (pattern < 0) pattern = add(candidate.data(), -1);
          above[block] = last = pattern;
          blocks.push_back({static_cast<std::int32_t>(start + block * kLanes), pattern});
        }
      }
      plane.row_ends.push_back(static_cast<std::int32_t>(plane.blocks[component].size()));
    }
  }
  generation_ = steady != nullptr ? steady->generation() : -2;
  blocks_.clear();
  segments_.clear();
  values_.clear();
  row_begin_.assign(1, 0);
  std::unordered_map<std::string_view, std::int32_t, PatternHash> known;
  std::vector<std::int32_t> number, renumbered(keeps ? last_patterns : 0, -1);
  const auto text = [](const Real* values) {
    return std::string_view(reinterpret_cast<const char*>(values), kSize * sizeof(Real));
  };
  for (const Plane& plane : planes) {
    number.clear();
    for (std::size_t p = 0; p < plane.origin.size(); ++p) {
      const std::int32_t origin = plane.origin[p];
      std::int32_t found = origin < 0 ? -1 : renumbered[origin];
      if (found < 0) {
        const Real* values = plane.values.data() + p * kSize;
        const auto [entry, fresh] = known.try_emplace(text(values), values_.size() / kSize);
        if (fresh) values_.insert(values_.end(), values, values + kSize);
        found = entry->second;
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
  }
  if (anew_) return;
  // Both in the same order: by rows, and along them.
  const std::size_t all = row_begin_.size() - 1;
  for (std::size_t at = 0; at < all; ++at) {
    auto now = row_begin_[at];
    for (auto b = last_begin[at]; b < last_begin[at + 1]; ++b) {
      while (now < row_begin_[at + 1] && blocks_[now].place < last_blocks[b].place) ++now;
      if (now < row_begin_[at + 1] && blocks_[now].place == last_blocks[b].place) continue;
      lost_.push_back({static_cast<std::int32_t>(at / rows % components), last_blocks[b].place});
    }
  }
}

}  // namespace monolith
