#include "solve/velocity_multigrid.h"

#include <algorithm>

#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

constexpr int kSmootherDegree = 2;
constexpr int kCoarsestDegree = 12;

}  // namespace

void VelocityMultigrid::setLevels(const std::vector<StaggeredCoefficients<float>>& levels, std::size_t count) {
  const bool same_shape = !levels_.empty() && levels_.size() == count && levels_[0].x[0].size() == levels[0].lattice.size;
  if (!same_shape) levels_.assign(count, Level());
  for (std::size_t i = 0; i < count; ++i) {
    Level& level = levels_[i];
    level.c = &levels[i];
    const std::size_t size = level.c->lattice.size;
    for (int a = 0; a < 3; ++a) {
      for (auto* field : {&level.x, &level.b, &level.r, &level.d}) (*field)[a].resize(size);
    }
    smoothingDiagonal(*level.c, level.inverse_diagonal);
    effectiveMass(*level.c, level.transfer);
    for (int a = 0; a < 3; ++a) {
      float* inverse = level.inverse_diagonal[a].data();
      float* transfer = level.transfer[a].data();
      const float* mass = level.c->mass[a].data();
#pragma omp parallel for simd schedule(static)
      for (std::size_t c = 0; c < size; ++c) {
        inverse[c] = inverse[c] > 0.0f ? 1.0f / inverse[c] : 0.0f;
        transfer[c] = mass[c] > 0.0f ? std::max(0.0f, 1.0f - (transfer[c] - mass[c]) * inverse[c]) : 0.0f;
      }
    }
    level.range.largest = static_cast<float>(kLargestScaled);
    level.range.ratio = 6.0f;
  }
  // The coarsest level is to be solved, not smoothed.
  if (count > 1) levels_.back().range.ratio = 60.0f;
}

void VelocityMultigrid::apply(Level& level, FaceField<float>& x, FaceField<float>& Ax) {
  for (auto& field : x) fillHalo(level.c->lattice, field);
  if (level.c->viscous) computeStress(*level.c, x, level.stress);
  applyMomentum(*level.c, x, level.stress, Ax);
}

void VelocityMultigrid::residual(Level& level) {
  apply(level, level.x, level.r);
  const auto size = static_cast<std::ptrdiff_t>(level.c->lattice.size);
  for (int a = 0; a < 3; ++a) {
    float* r = level.r[a].data();
    const float* b = level.b[a].data();
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t c = 0; c < size; ++c) r[c] = b[c] - r[c];
  }
}

void VelocityMultigrid::smooth(Level& level, int degree, bool from_zero) {
  const auto size = static_cast<std::ptrdiff_t>(level.c->lattice.size);
  ChebyshevRecurrence recurrence(level.range);
  for (int step = 0; step < degree; ++step) {
    const bool zero = from_zero && step == 0;
    if (!zero) residual(level);
    if (step > 0) recurrence.next();
    const float keep = recurrence.keep();
    const float scale = recurrence.scale();
    for (int a = 0; a < 3; ++a) {
      float* x = level.x[a].data();
      float* d = level.d[a].data();
      const float* r = zero ? level.b[a].data() : level.r[a].data();
      const float* inverse = level.inverse_diagonal[a].data();
      const float* start = x;
      if (step == 0) {
#pragma omp parallel for simd schedule(static)
        for (std::ptrdiff_t c = 0; c < size; ++c) {
          d[c] = scale * inverse[c] * r[c];
          x[c] = (zero ? 0.0f : start[c]) + d[c];
        }
      } else {
#pragma omp parallel for simd schedule(static)
        for (std::ptrdiff_t c = 0; c < size; ++c) {
          d[c] = keep * d[c] + scale * inverse[c] * r[c];
          x[c] += d[c];
        }
      }
    }
  }
}

void VelocityMultigrid::descend(std::size_t index) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) {
    smooth(level, levels_.size() == 1 ? 2 * kSmootherDegree : kCoarsestDegree, true);
    return;
  }
  smooth(level, kSmootherDegree, true);
  residual(level);
  Level& coarse = levels_[index + 1];
  const Lattice& l = level.c->lattice;
  for (int a = 0; a < 3; ++a) {
    float* r = level.r[a].data();
    const float* transfer = level.transfer[a].data();
#pragma omp parallel for simd schedule(static)
    for (std::size_t c = 0; c < l.size; ++c) r[c] *= transfer[c];
    fillHalo(l, level.r[a]);
    restrictResidual(l, a, level.r[a], coarse.c->lattice, coarse.b[a]);
  }
  descend(index + 1);
  for (int a = 0; a < 3; ++a) {
    fillHalo(coarse.c->lattice, coarse.x[a]);
    clearHalo(l, level.x[a]);
    prolongateFaces(coarse.c->lattice, a, coarse.x[a], l, level.transfer[a], level.x[a]);
  }
  smooth(level, kSmootherDegree, false);
}

void VelocityMultigrid::cycle(const FaceField<float>& b, FaceField<float>& x) {
  Level& fine = levels_[0];
  fine.b = b;
  descend(0);
  x = fine.x;
  for (auto& field : x) clearHalo(fine.c->lattice, field);
}

}  // namespace monolith
