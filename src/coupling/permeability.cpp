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
                       const FaceRows<float>& free) {
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
  RowField<float> share;
  std::vector<float> held;
  for (int a = 0; a < 3; ++a) {
    const OpenParts<double> open = problem.coefficients.open(a);
    const std::vector<double>& mass = problem.coefficients.mass[a];
    share.transform(
        free[a], [&](std::ptrdiff_t f, float) { return mass[f] > 0.0 ? static_cast<float>(open[f] / mass[f]) : 0.0F; });
    assignZero(l.size, held);
    prolongateFaces(level.lattice, a, coarse_[a].data(), l, allPlanes(l), share, held.data());
    impulse_[a].transform(free[a], [&](std::ptrdiff_t f, float impulse) { return std::min(impulse, held[f]); });
  }
  sharp_.resize(l.size);
  const float* viscosity = problem.cell_viscosity.empty() ? nullptr : problem.cell_viscosity.data();
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    std::uint8_t* out = sharp_.data() + row;
    std::fill_n(out, l.faceEnd(0), std::uint8_t{0});
    for (int a = 0; a < 3; ++a) {
      for (const auto at : {row, row + l.stride[a]}) {
        const float* impulse = free[a].row(at);
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
