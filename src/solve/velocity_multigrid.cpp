#include "solve/velocity_multigrid.h"

#include "solve/staggered_transfer.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr int kCoarsestDegree = 12;
static_assert(kCoarsestDegree % 2 == 0, "see cycleFrom()");
constexpr float kRatio = 6.0f;
constexpr float kCoarsestRatio = 60.0f;  // the coarsest level is to be solved, not smoothed

Faces<float> view(FaceField<float>& f) { return {f[0].data(), f[1].data(), f[2].data()}; }
Faces<const float> constView(const FaceField<float>& f) { return {f[0].data(), f[1].data(), f[2].data()}; }
Faces<const float> constView(const Faces<float>& f) { return {f[0], f[1], f[2]}; }

}  // namespace

void VelocityMultigrid::set(const Lattice& lattice, const FaceBlocks<float>& fine, const FaceRows<float>& transfer,
                            const std::vector<StaggeredCoefficients<float>>& coarse, std::size_t count, long generation,
                            int smoother_degree) {
  degree_ = smoother_degree;
  levels_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Level& level = levels_[i];
    level.range.largest = static_cast<float>(kLargestScaled);
    level.range.ratio = count > 1 && i + 1 == count ? kCoarsestRatio : kRatio;
    level.blocks = i == 0 ? &fine : &level.own;
    level.transfer = i == 0 ? &transfer : &level.own_transfer;
    if (i > 0 && level.generation == generation) continue;
    level.generation = i == 0 ? -1 : generation;
    level.lattice = i == 0 ? lattice : coarse[i].lattice;
    if (i > 0) buildFaceBlocks(coarse[i], level.own, &level.own_transfer, nullptr);
    // Zero where nothing is written: other faces than last time may have an unknown now.
    for (int a = 0; a < 3; ++a) {
      for (auto* fields : {&level.own_next, &level.d}) level.blocks->clear(a, level.build, (*fields)[a]);
      if (i == 0) continue;
      level.blocks->clear(a, level.build, level.own_x[a]);
      assignZero(level.lattice.size, level.b[a]);
    }
    level.build = level.blocks->build();
  }
}

void VelocityMultigrid::smooth(Level& level, int degree, bool from_zero) {
  const Lattice& l = level.lattice;
  ChebyshevRecurrence recurrence(level.range);
  for (int step = 0; step < degree; ++step) {
    if (step > 0) recurrence.next();
    if (from_zero && step == 0) {
      chebyshevStart(*level.blocks, level.right, recurrence.scale(), view(level.d), level.x);
    } else {
      chebyshevStep(l, *level.blocks, constView(level.x), level.right, recurrence.keep(), recurrence.scale(),
                    view(level.d), level.next);
      std::swap(level.x, level.next);
    }
    for (float* field : level.x) fillHalo(l, field);
  }
}

void VelocityMultigrid::descend(std::size_t index) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) {
    smooth(level, levels_.size() == 1 ? 2 * degree_ : kCoarsestDegree, true);
    return;
  }
  smooth(level, degree_, true);
  const Lattice& l = level.lattice;
  Level& coarse = levels_[index + 1];
  transferredResidual(l, *level.blocks, constView(level.x), level.right, level.next);
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, level.next[a]);
    restrictResidual(l, a, level.next[a], coarse.lattice, coarse.blocks->planes(), coarse.b[a].data());
  }
  cycleFrom(index + 1, constView(coarse.b), view(coarse.own_x));
  for (int a = 0; a < 3; ++a) {
    prolongateFaces(coarse.lattice, a, coarse.own_x[a].data(), l, level.blocks->planes(), (*level.transfer)[a],
                    level.x[a]);
    fillHalo(l, level.x[a]);
  }
  smooth(level, degree_, false);
}

void VelocityMultigrid::cycleFrom(std::size_t index, const Faces<const float>& b, const Faces<float>& x) {
  Level& level = levels_[index];
  level.right = b;
  // An even number of smoothing steps, all but the first of which take a turn: the last ends in x.
  level.x = view(level.own_next);
  level.next = x;
  descend(index);
}

void VelocityMultigrid::coarseCycle(const FaceField<float>& b, FaceField<float>& x) {
  for (auto& field : x) assignZero(levels_[1].lattice.size, field);
  cycleFrom(1, constView(b), view(x));
}

void VelocityMultigrid::cycle(const Faces<const float>& b, const Faces<float>& x) { cycleFrom(0, b, x); }

}  // namespace monolith
