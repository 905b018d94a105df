#include "coupling/permeability.h"

#include <algorithm>

#include "solve/staggered_transfer.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// Next to solids k goes to zero, and on cells twice as wide a narrow gap may have none: so much times 1/N it has at
// least.
constexpr double kLeast = 0.1;
// A face that conducts as much as one in the open, about.
constexpr float kLeastOpen = 0.7f, kMostOpen = 1.5f;

}  // namespace

void Permeability::set(const StepProblem& problem, double largest_number, VelocityMultigrid& velocity,
                       const FaceField<float>& free) {
  const Lattice& l = problem.grid.lattice;
  const StaggeredCoefficients<float>& level = problem.coarse.levels[1];
  lasted_ = generation_ == problem.coarse.generation();
  generation_ = problem.coarse.generation();
  if (!lasted_) {
    velocity.coarseCycle(level.mass, coarse_);
    const float least = static_cast<float>(std::min(1.0, kLeast / largest_number));
    for (auto& field : coarse_) {
      for (float& k : field) k = std::max(k, least);
    }
  }
  share_.resize(l.size);
  for (int a = 0; a < 3; ++a) {
    const auto &mass = problem.coefficients.mass[a], &fluid = problem.coefficients.fluid()[a];
    assignZero(l.size, impulse_[a]);
#pragma omp parallel for simd schedule(static)
    for (std::size_t f = 0; f < l.size; ++f) share_[f] = mass[f] > 0.0 ? static_cast<float>(fluid[f] / mass[f]) : 0.0f;
    prolongateFaces(level.lattice, a, coarse_[a].data(), l, allPlanes(l), share_.data(), impulse_[a].data());
#pragma omp parallel for simd schedule(static)
    for (std::size_t f = 0; f < l.size; ++f) impulse_[a][f] = std::min(free[a][f], impulse_[a][f]);
    fillHalo(l, impulse_[a]);
  }
  sharp_.resize(l.size);
  const float* viscosity = problem.cell_viscosity.empty() ? nullptr : problem.cell_viscosity.data();
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    std::uint8_t* out = sharp_.data() + row;
    std::fill_n(out, l.faceEnd(0), std::uint8_t{0});
    for (int a = 0; a < 3; ++a) {
      for (const auto at : {row, row + l.stride[a]}) {
        const float* impulse = free[a].data() + at;
        const double* fluid = problem.coefficients.fluid()[a].data() + at;
        for (int i = 0; i < l.n[0]; ++i) {
          const float conductance = static_cast<float>(fluid[i]) * impulse[i];
          out[i] |= !(conductance > kLeastOpen && conductance < kMostOpen);
        }
      }
    }
    if (viscosity == nullptr) return;
    for (int i = 0; i < l.n[0]; ++i) out[i] |= problem.viscous_number * viscosity[row + i] < kLeastHolding;
  });
  fillHalo(l, sharp_);
}

}  // namespace monolith
