#include "coupling/liquid_preconditioner.h"

#include <algorithm>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// Below this the mass term dominates and one smoothing sweep on the level is a solve.
constexpr double kLeastViscousNumber = 0.05;

float removeMean(const std::vector<std::ptrdiff_t>& cells, float* field) {
  const auto size = static_cast<std::ptrdiff_t>(cells.size());
  const double sum = blockedSum<double>(size, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double part = 0.0;
    for (auto i = begin; i < end; ++i) part += field[cells[i]];
    return part;
  });
  const float mean = static_cast<float>(sum / static_cast<double>(size));
#pragma omp parallel for schedule(static) if (cells.size() >= kSizeWorthSharing)
  for (std::ptrdiff_t i = 0; i < size; ++i) field[cells[i]] -= mean;
  return mean;
}

}  // namespace

void LiquidPreconditioner::set(const StepProblem& problem, const FaceBlocks<float>& faces,
                               const CellBlocks<float>& cells, FaceField<float>&& transfer,
                               FaceField<float>&& conductance) {
  problem_ = &problem;
  faces_ = &faces;
  cells_ = &cells;
  const Lattice& l = problem.grid.lattice;
  double number = problem.viscous_number;
  if (!problem.cell_viscosity.empty()) {
    number *= *std::max_element(problem.cell_viscosity.begin(), problem.cell_viscosity.end());
  }
  std::size_t levels = 1;
  while (levels < problem.coarse.size() && number > kLeastViscousNumber) {
    ++levels;
    number *= 0.25;
  }
  if (problem.coefficients.viscous) velocity_.set(l, faces, std::move(transfer), problem.coarse, levels);
  pressure_.set(l, problem.coefficients.has_pressure, std::move(conductance));
  g_.assign(l.size, 0.0f);
}

void LiquidPreconditioner::apply(const float* r, float* x) {
  const Lattice& l = problem_->grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const Faces<const float> b{r, r + size, r + 2 * size};
  const Faces<float> out{x, x + size, x + 2 * size};
  Faces<const float> u{x, x + size, x + 2 * size};
  if (problem_->coefficients.viscous) {
    u = velocity_.cycle(b);
  } else {
    // The diagonal is all there is.
    chebyshevStart(*faces_, b, 1.0f, out, out);
    for (float* field : out) fillHalo(l, field);
  }
  applyDivergence(l, *cells_, u, -1.0f, r + 3 * size, g_.data());
  std::vector<float> constants;
  for (const PressureRegion& region : problem_->regions) {
    if (region.sealed) constants.push_back(removeMean(region.cells, g_.data()));
  }
  float* phi = pressure_.cycle(g_.data());
  std::size_t sealed = 0;
  for (const PressureRegion& region : problem_->regions) {
    if (!region.sealed) continue;
    removeMean(region.cells, phi);
    // The constant of a pocket between free bodies is their doing alone; any positive scale lets the Krylov method find it.
    if (!region.null_mode) {
      for (const auto cell : region.cells) phi[cell] += constants[sealed];
    }
    ++sealed;
  }
  if (sealed > 0) fillHalo(l, phi);
  project(l, *faces_, u, phi, out);
  float* p = x + 3 * size;
  const float twice = 2.0f * static_cast<float>(problem_->viscous_number);
  const float* g = g_.data();
  if (problem_->cell_viscosity.empty()) {
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t i = 0; i < size; ++i) p[i] = phi[i] + twice * g[i];
  } else {
    const float* ratio = problem_->cell_viscosity.data();
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t i = 0; i < size; ++i) p[i] = phi[i] + twice * ratio[i] * g[i];
  }
  for (float* field : {x, x + size, x + 2 * size, p}) fillHalo(l, field);
}

}  // namespace monolith
