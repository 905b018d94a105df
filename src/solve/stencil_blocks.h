#pragma once
// A stencil operator on a lattice, compressed: x-rows are cut into blocks of kLanes unknowns, and each block names a
// pattern of its plane, the coefficients of its lanes. Blocks of a plane that look alike - everything away from
// boundaries, and most of what lies along walls - share one pattern, and planes that look alike share all of theirs, so
// that the coefficients of a level stay in the first cache and only the fields are streamed. Blocks without any unknown
// are left out; lanes without one have coefficients of zero.
//
// Coefficient q of lane i of pattern p: values[(p * Count + q) * kLanes + i].

#include <omp.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "solve/index_table.h"
#include "solve/lattice.h"
#include "solve/steady_rows.h"
#include "solve/whole_fields.h"

namespace monolith {

// Fewer blocks than this are not worth waking a second thread for.
constexpr std::ptrdiff_t kBlocksWorthSharing = 500;

// What does not depend on the coefficients.
struct StencilLayout {
  struct Block {
    std::int32_t place, pattern;
  };
  // Blocks of one component in one plane, numbered through all planes; those of the plane begin at `plane_begin`.
  struct Segment {
    std::int32_t component, plane, plane_begin, begin, end;
  };
  struct Lost {
    std::int32_t component, place;
  };
};

template <class Real, int Count>
class StencilBlocks : private StencilLayout {
 public:
  static constexpr int kCount = Count;
  using Row = std::array<std::vector<Real>, Count>;
  using StencilLayout::Lost;

  // fill(component, row, width, out) writes the coefficients of `width` lanes from index `row` on, all zero: no
  // unknown; or returns false, then there is none in the row. `first[component]`: index along x of the first lane of a
  // row. It is not called for rows that are steady since the last build, if that was of the generation before.
  template <class FillRow>
  void build(const Lattice& l, const std::vector<int>& first, FillRow&& fill, const SteadyRows* steady = nullptr);

  // Kernels write blocks only: a field is zero elsewhere if it was before. One that has followed every build, the last
  // of them `build`, needs zeros just in the blocks that are lost since: clears those of a component, else all of it.
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
  const std::vector<Lost>& lost() const { return lost_; }

  // The next build makes all rows anew, steady or not.
  void distrust() { generation_ = kNoGeneration; }
  // Whether a build with these would leave steady rows as they are.
  bool wouldKeep(const SteadyRows* steady) const { return steady != nullptr && steady->isSuccessor(generation_); }

  // f(component, place, values): for every block, shared among threads; f must write its own lanes only.
  template <class BlockFunction>
  void forEach(BlockFunction&& f) const {
    const auto total = static_cast<std::ptrdiff_t>(blocks());
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

  // f(component, place, values): for the blocks of a plane, of an operator that was built, not converted.
  template <class BlockFunction>
  void forEachOfPlane(int k, BlockFunction&& f) const {
    const Plane& plane = planes_[k];
    const int rows = lattice_.faceEnd(1), components = static_cast<int>(plane.row_begin.size() - 1) / rows;
    for (int component = 0; component < components; ++component) {
      for (auto b = plane.row_begin[component * rows]; b < plane.row_begin[(component + 1) * rows]; ++b) {
        f(component, static_cast<std::ptrdiff_t>(plane.blocks[b].place), plane.pattern(plane.blocks[b].pattern));
      }
    }
  }
  // Whether the plane may not be what it was in the build before.
  bool changed(int k) const { return changed_[k] != 0; }

  // Those that have blocks.
  Planes planes() const { return with_blocks_; }
  std::size_t blocks() const { return segments_.empty() ? 0 : segments_.back().end; }
  std::size_t lanes() const { return blocks() * kLanes; }
  // That differ, or are of planes that do.
  std::size_t patterns() const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      if (alike_[k] == static_cast<std::int32_t>(k)) count += planes_[k].hash.size();
    }
    return count;
  }

  // The same in another precision. Where that was made of the build before, only what has changed since.
  template <class To>
  void convertTo(StencilBlocks<To, Count>& out) const {
    const bool known = follows(out.build_) && out.planes_.size() == planes_.size();
    out.planes_.resize(planes_.size());
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      if (known && !changed_[k]) continue;
      out.planes_[k].blocks = planes_[k].blocks;
      out.planes_[k].hash = planes_[k].hash;
      out.planes_[k].values.assign(planes_[k].values.begin(), planes_[k].values.end());
    }
    out.alike_ = alike_;
    out.segments_ = segments_;
    out.with_blocks_ = with_blocks_;
    out.lattice_ = lattice_;
    out.anew_ = anew_;
    out.build_ = build_;
    out.lost_ = lost_;
  }

 private:
  template <class, int>
  friend class StencilBlocks;

  static constexpr std::size_t kSize = Count * kLanes;
  static constexpr long kNoGeneration = -2;

  struct Plane {
    std::vector<Block> blocks;            // by components, within them by rows
    std::vector<std::int32_t> row_begin;  // in blocks, of every row; one more at the end
    std::vector<std::uint64_t> hash;      // of each pattern
    std::vector<Real> values;

    // All but its memory.
    void clear() {
      blocks.clear();
      row_begin.clear();
      hash.clear();
      values.clear();
    }
    void add(const Real* pattern, std::uint64_t pattern_hash) {
      values.insert(values.end(), pattern, pattern + kSize);
      hash.push_back(pattern_hash);
    }
    const Real* pattern(std::int32_t p) const { return values.data() + p * kSize; }
  };

  // `before` is what the plane was; its rows that are steady in `kept` are taken from there.
  template <class FillRow>
  void buildPlane(int k, const std::vector<int>& first, FillRow&& fill, const SteadyRows* kept, const Plane& before,
                  Plane& plane) const;
  static void findLost(const Plane& before, const Plane& plane, int rows, std::vector<Lost>& lost);
  void arrange(int components);

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
  static bool samePatterns(const Plane& a, const Plane& b) {
    return a.hash == b.hash && std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(Real)) == 0;
  }

  template <class BlockFunction>
  void run(std::ptrdiff_t begin, std::ptrdiff_t end, BlockFunction&& f) const {
    for (const Segment& segment : segments_) {
      const Block* blocks = planes_[segment.plane].blocks.data() - segment.plane_begin;
      const Real* values = planes_[alike_[segment.plane]].values.data();
      const auto last = std::min<std::ptrdiff_t>(end, segment.end);
      for (auto i = std::max<std::ptrdiff_t>(begin, segment.begin); i < last; ++i) {
        f(segment.component, static_cast<std::ptrdiff_t>(blocks[i].place), values + blocks[i].pattern * kSize);
      }
    }
  }

  std::vector<Plane> planes_;
  std::vector<std::int32_t> alike_;    // of each plane, the lowest of those next to it that have the same patterns
  std::vector<std::uint8_t> changed_;  // planes that are not those of the build before
  std::vector<Segment> segments_;
  Planes with_blocks_;
  long generation_ = kNoGeneration;  // of the steady rows that it was built with
  Lattice lattice_;
  bool anew_ = true;  // the last build was the first on its lattice
  long build_ = 0;
  std::vector<Lost> lost_;    // blocks that the build before had
  std::vector<Plane> spare_;  // of each thread, of use within a build only, kept for their memory
};

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::build(const Lattice& l, const std::vector<int>& first, FillRow&& fill,
                                       const SteadyRows* steady) {
  const int components = static_cast<int>(first.size()), planes = l.faceEnd(2), rows = l.faceEnd(1);
  anew_ = build_ == 0 || lattice_.n != l.n || lattice_.periodic != l.periodic;
  const bool keeps = !anew_ && wouldKeep(steady);
  lattice_ = l;
  ++build_;
  generation_ = steady != nullptr ? steady->generation() : kNoGeneration;
  planes_.resize(planes);
  changed_.resize(planes);
  spare_.resize(std::max<std::size_t>(spare_.size(), omp_get_max_threads()));
  std::vector<std::vector<Lost>> lost(planes);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < planes; ++k) {
    bool changes = !keeps;
    for (int j = 0; j < rows && !changes; ++j) changes = !steady->steady(j, k);
    changed_[k] = changes ? 1 : 0;
    if (!changes) continue;
    Plane& next = spare_[omp_get_thread_num()];
    buildPlane(k, first, fill, keeps ? steady : nullptr, planes_[k], next);
    if (!anew_) findLost(planes_[k], next, rows, lost[k]);
    planes_[k] = next;  // copied: its memory is as much as it needs
  }
  lost_.clear();
  for (const auto& of_plane : lost) lost_.insert(lost_.end(), of_plane.begin(), of_plane.end());
  arrange(components);
}

template <class Real, int Count>
template <class FillRow>
void StencilBlocks<Real, Count>::buildPlane(int k, const std::vector<int>& first, FillRow&& fill,
                                            const SteadyRows* kept, const Plane& before, Plane& plane) const {
  const Lattice& l = lattice_;
  const int components = static_cast<int>(first.size());
  const int row_blocks = (l.n[0] + kLanes - 1) / kLanes;
  const int rows = l.faceEnd(1);
  plane.clear();
  Row row;
  for (auto& r : row) r.resize(row_blocks * kLanes);
  std::vector<Real> candidate(kSize);
  IndexTable table(static_cast<std::size_t>(components) * rows * row_blocks);
  const auto number = [&](const Real* pattern, std::uint64_t hash) {
    const std::int32_t found =
        table.number(hash, [&](std::int32_t p) { return plane.hash[p] == hash && same(plane.pattern(p), pattern); });
    if (found == static_cast<std::int32_t>(plane.hash.size())) plane.add(pattern, hash);
    return found;
  };
  // Of the patterns that the plane had, which they are now.
  std::vector<std::int32_t> here(kept != nullptr ? before.hash.size() : 0, -1);
  for (int component = 0; component < components; ++component) {
    std::vector<std::int32_t> above(row_blocks, -1);  // patterns of the row before
    std::int32_t last = -1;
    for (int j = 0; j < rows; ++j) {
      plane.row_begin.push_back(static_cast<std::int32_t>(plane.blocks.size()));
      const auto start = l.index(first[component], j, k);
      if (kept != nullptr && kept->steady(j, k)) {
        const std::size_t at = static_cast<std::size_t>(component) * rows + j;
        for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
          const Block& block = before.blocks[b];
          std::int32_t& pattern = here[block.pattern];
          if (pattern < 0) pattern = number(before.pattern(block.pattern), before.hash[block.pattern]);
          above[(block.place - start) / kLanes] = last = pattern;
          plane.blocks.push_back({block.place, pattern});
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
          return pattern >= 0 && same(plane.pattern(pattern), candidate.data());
        };
        std::int32_t pattern = fits(above[block]) ? above[block] : fits(last) ? last : -1;
        if (pattern < 0) pattern = number(candidate.data(), hashOf(candidate.data()));
        above[block] = last = pattern;
        plane.blocks.push_back({static_cast<std::int32_t>(start + block * kLanes), pattern});
      }
    }
  }
  plane.row_begin.push_back(static_cast<std::int32_t>(plane.blocks.size()));
}

// Both in the same order: by rows, and along them.
template <class Real, int Count>
void StencilBlocks<Real, Count>::findLost(const Plane& before, const Plane& plane, int rows, std::vector<Lost>& lost) {
  const int all = static_cast<int>(plane.row_begin.size()) - 1;
  for (int at = 0; at < all; ++at) {
    auto now = plane.row_begin[at];
    const auto end = plane.row_begin[at + 1];
    for (auto b = before.row_begin[at]; b < before.row_begin[at + 1]; ++b) {
      const std::int32_t place = before.blocks[b].place;
      while (now < end && plane.blocks[now].place < place) ++now;
      if (now == end || plane.blocks[now].place != place) lost.push_back({at / rows, place});
    }
  }
}

template <class Real, int Count>
void StencilBlocks<Real, Count>::arrange(int components) {
  const int rows = lattice_.faceEnd(1);
  alike_.resize(planes_.size());
  segments_.clear();
  with_blocks_ = {};
  std::int32_t count = 0;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(planes_.size()); ++k) {
    const Plane& plane = planes_[k];
    alike_[k] = k;
    if (k > 0 && samePatterns(plane, planes_[alike_[k - 1]])) alike_[k] = alike_[k - 1];
    const std::int32_t plane_begin = count;
    for (int component = 0; component < components; ++component) {
      const std::int32_t begin = count;
      count = plane_begin + plane.row_begin[(component + 1) * rows];
      if (count > begin) segments_.push_back({component, k, plane_begin, begin, count});
    }
    if (count > plane_begin) {
      if (with_blocks_.end == 0) with_blocks_.first = k;
      with_blocks_.end = k + 1;
    }
  }
}

}  // namespace monolith
