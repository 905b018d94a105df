#pragma once
// How far viscosity lets pressure move the liquid within a step. A difference of pressure over a face accelerates it by
// open/mass; what ties it to solids divides that by its effective mass (staggered_operator.h); and what holds the
// liquid around it back does so, too: of a uniform push liquid takes on the part
//
//   k = A^-1 mass 1        1 in the open, 0 on solids, small between many of them
//
// as a porous medium would (Brinkman 1949, Appl. Sci. Res. A1, 27): waves of pressure that are longer than the layer in
// which viscosity acts, sqrt(N) cells, see conductances smaller by k. Shorter ones do not need it: that is what the
// viscous part of the pressure's preconditioner is for (liquid_preconditioner.h).
//
// k is found by one multigrid cycle on cells twice as wide. It steers the solve and never decides its answer.

#include <cstdint>
#include <vector>

#include "coupling/step_problem.h"
#include "solve/velocity_multigrid.h"

namespace monolith {

// Viscous number from which on viscosity acts further than within a cell.
constexpr double kLeastHolding = 1.0;

class Permeability {
 public:
  // largest_number: viscous number where the viscosity is largest. velocity: that of the problem, with more than one
  // level. free: the impulse of faces whose neighbours are held (buildFaceBlocks()).
  void set(const StepProblem& problem, double largest_number, VelocityMultigrid& velocity, const FaceRows<float>& free);
  // Whether k itself is what it was at the call before.
  bool lasted() const { return lasted_; }
  void forget() { generation_ = -1; }

  // min(free, k open/mass) at each face, halo filled.
  const FaceRows<float>& impulse() const { return impulse_; }
  // Cells between which short waves of pressure matter all the same: next to a solid or the surface, or where the
  // viscosity is small.
  const std::vector<std::uint8_t>& sharp() const { return sharp_; }

 private:
  FaceField<float> coarse_;
  FaceRows<float> impulse_;
  std::vector<std::uint8_t> sharp_;
  long generation_ = -1;  // of the coarse levels that k was found with
  bool lasted_ = false;
};

}  // namespace monolith
