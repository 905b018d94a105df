#include "coupling/liquid_preconditioner.h"

#include <algorithm>

#include "solve/blocked_sum.h"
#include "solve/kernel_work.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// Where viscosity holds the liquid back, more smoothing pays: fewer vectors to orthogonalise.
constexpr int kSmootherDegree = 2;
constexpr int kViscousSmootherDegree = 3;

void addTo(float* field, std::ptrdiff_t size, float constant) {
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < size; ++i) field[i] += constant;
}

// Streams the field twice, for 2 flops a cell.
float removeMean(const PressureRegion& region, float* field) {
  countWork(region.cells, 2.0, 3.0 * sizeof(float));
  const double sum =
      region.sum([&](std::ptrdiff_t begin, std::ptrdiff_t end) { return sumOf(field + begin, end - begin); });
  const float mean = static_cast<float>(sum / static_cast<double>(region.cells));
  region.forEachRun([&](std::ptrdiff_t begin, std::ptrdiff_t end) { addTo(field + begin, end - begin, -mean); });
  return mean;
}

}  // namespace

void LiquidPreconditioner::set(const StepProblem& problem, const FaceBlocks<float>& faces,
                               const CellBlocks<float>& cells, const FaceRows<float>& transfer,
                               const FaceRows<float>& impulse) {
  problem_ = &problem;
  faces_ = &faces;
  cells_ = &cells;
  const Lattice& l = problem.grid.lattice;
  double largest = problem.viscous_number;
  if (!problem.cell_viscosity.empty()) {
    largest *= *std::max_element(problem.cell_viscosity.begin(), problem.cell_viscosity.end());
  }
  std::size_t levels = 1;
  double number = largest;
  while (levels < problem.coarse.levels.size() && number > kLeastCoarsenedNumber) {
    ++levels;
    number *= 0.25;
  }
  const bool holding = largest > kLeastHolding && levels > 1;
  if (problem.coefficients.viscous) {
    velocity_.set(l, faces, transfer, problem.coarse.levels, levels, problem.coarse.generation(),
                  holding ? kViscousSmootherDegree : kSmootherDegree);
  }
  impulse_ = &impulse;
  if (holding) {
    permeability_.set(problem, largest, velocity_, impulse);
    impulse_ = &permeability_.impulse();
    if (!permeability_.lasted()) pressure_.distrust();
  } else {
    permeability_.forget();
  }
  pressure_.set(l, problem.coefficients.has_pressure, problem.coefficients.fluid(), *impulse_, &problem.steady,
                holding ? &permeability_.sharp() : nullptr);
  cells.clear(0, build_, g_);
  build_ = cells.build();
  if (!problem.coefficients.viscous || weight_.size() != l.size) assignZero(l.size, weight_);
  if (!problem.coefficients.viscous) return;
  const auto& normal = problem.coefficients.normal;
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    const float *x = normal[0].row(row), *y = normal[1].row(row), *z = normal[2].row(row);
    for (int i = 0; i < l.n[0]; ++i) {
      const double ratio = problem.cell_viscosity.empty() ? 1.0 : problem.cell_viscosity[row + i];
      const double mean = (x[i] + y[i] + z[i]) / 3.0;
      weight_[row + i] = static_cast<float>(std::min(mean, 2.0 * ratio * problem.viscous_number));
    }
  });
}

void LiquidPreconditioner::apply(const float* r, float flux_scale, float* x) {
  const Lattice& l = problem_->grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const Faces<const float> b{r, r + size, r + 2 * size};
  const Faces<float> out{x, x + size, x + 2 * size};
  const Faces<const float> u{x, x + size, x + 2 * size};
  if (problem_->coefficients.viscous) {
    velocity_.cycle(b, out);
  } else {
    // The diagonal is all there is.
    chebyshevStart(*faces_, b, 1.0f, out, out);
    for (float* field : out) fillHalo(l, field);
  }
  applyDivergence(l, *cells_, u, -flux_scale, r + 3 * size, g_.data());
  std::vector<float> constants;
  for (const PressureRegion& region : problem_->regions) {
    if (region.sealed) constants.push_back(removeMean(region, g_.data()));
  }
  float* phi = pressure_.cycle(g_.data());
  std::size_t sealed = 0;
  for (const PressureRegion& region : problem_->regions) {
    if (!region.sealed) continue;
    removeMean(region, phi);
    // The constant of a pocket between free bodies is their doing alone; any positive scale lets the Krylov method find
    // it.
    if (!region.null_mode) {
      region.forEachRun(
          [&](std::ptrdiff_t begin, std::ptrdiff_t end) { addTo(phi + begin, end - begin, constants[sealed]); });
    }
    ++sealed;
  }
  if (sealed > 0) fillHalo(l, phi);
  project(l, faces_->planes(), *impulse_, u, phi, out);
  float* p = x + 3 * size;
  const Planes& planes = cells_->planes();
  countWork(static_cast<std::size_t>(l.stride[2] * (planes.end - planes.first)), 2.0, 4.0 * sizeof(float));
#pragma omp parallel for schedule(static)
  for (int k = planes.first; k < planes.end; ++k) {
    const float *g = g_.data(), *weight = weight_.data();
    const std::ptrdiff_t begin = l.planeBegin(k), end = begin + l.stride[2];
#pragma omp simd
    for (std::ptrdiff_t i = begin; i < end; ++i) p[i] = phi[i] + weight[i] * g[i];
  }
  for (float* field : {x, x + size, x + 2 * size, p}) fillHalo(l, field);
}

}  // namespace monolith
