#include "coupling/liquid_preconditioner.h"

#include <algorithm>

namespace monolith {
namespace {

// Below this the mass term dominates and one smoothing sweep on the level is a solve.
constexpr double kLeastViscousNumber = 0.05;

float removeMean(const std::vector<std::ptrdiff_t>& cells, std::vector<float>& field) {
  double sum = 0.0;
  for (const auto c : cells) sum += field[c];
  const float mean = static_cast<float>(sum / static_cast<double>(cells.size()));
  for (const auto c : cells) field[c] -= mean;
  return mean;
}

}  // namespace

void LiquidPreconditioner::set(std::vector<StaggeredCoefficients<float>>&& levels, double viscous_number,
                               const std::vector<float>* cell_viscosity,
                               const std::vector<PressureRegion>* regions) {
  levels_ = std::move(levels);
  viscous_number_ = static_cast<float>(viscous_number);
  cell_viscosity_ = cell_viscosity;
  regions_ = regions;
  std::size_t velocity_levels = 1;
  double number = viscous_number;
  if (!cell_viscosity->empty()) number *= *std::max_element(cell_viscosity->begin(), cell_viscosity->end());
  while (velocity_levels < levels_.size() && number > kLeastViscousNumber) {
    ++velocity_levels;
    number *= 0.25;
  }
  if (viscous_number > 0.0) velocity_.setLevels(levels_, velocity_levels);
  pressure_.set(levels_[0]);
}

void LiquidPreconditioner::apply(const StepVector& r, StepVector& x) {
  const StaggeredCoefficients<float>& c = levels_[0];
  const Lattice& l = c.lattice;
  for (int a = 0; a < 3; ++a) {
    b_[a].resize(l.size);
    u_[a].resize(l.size);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < l.size; ++i) b_[a][i] = static_cast<float>(r.velocity[a][i]);
  }
  if (c.viscous) {
    velocity_.cycle(b_, u_);
  } else {
    for (int a = 0; a < 3; ++a) {
#pragma omp parallel for simd schedule(static)
      for (std::size_t i = 0; i < l.size; ++i) u_[a][i] = c.mass[a][i] > 0.0f ? b_[a][i] / c.mass[a][i] : 0.0f;
    }
  }
  g_.resize(l.size);
  for (auto& field : u_) fillHalo(l, field);
  computeDivergence(c, u_, g_);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < l.size; ++i) {
    g_[i] = c.has_pressure[i] ? -static_cast<float>(r.pressure[i]) - g_[i] : 0.0f;
  }
  std::vector<float> constants;
  for (const PressureRegion& region : *regions_) {
    if (region.sealed) constants.push_back(removeMean(region.cells, g_));
  }
  pressure_.cycle(g_, phi_);
  std::size_t sealed = 0;
  for (const PressureRegion& region : *regions_) {
    if (!region.sealed) continue;
    removeMean(region.cells, phi_);
    // The constant of a pocket between free bodies is their doing alone; any positive scale lets the Krylov method find it.
    if (!region.null_mode) {
      for (const auto cell : region.cells) phi_[cell] += constants[sealed];
    }
    ++sealed;
  }
  fillHalo(l, phi_);
  addPressureImpulse(c, pressure_.mass(), phi_, u_);
  for (int a = 0; a < 3; ++a) {
    clearHalo(l, u_[a]);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < l.size; ++i) x.velocity[a][i] = u_[a][i];
  }
  clearHalo(l, phi_);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < l.size; ++i) x.pressure[i] = phi_[i] + 2.0f * viscous_number_ * g_[i];
  if (cell_viscosity_->empty()) return;
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < l.size; ++i) {
    x.pressure[i] = phi_[i] + 2.0f * viscous_number_ * (*cell_viscosity_)[i] * g_[i];
  }
}

}  // namespace monolith
