#pragma once
// Projection preconditioner of the liquid's own block [A_uu, -C^T; -C, 0], in single precision: one multigrid cycle on
// A_uu, one on L = C mass^-1 C^T with p^ = phi + 2 N g (Cahouet & Chabard 1988). Linear: the same map on every call.

#include <vector>

#include "coupling/pressure_regions.h"
#include "coupling/step_problem.h"
#include "solve/pressure_multigrid.h"
#include "solve/velocity_multigrid.h"

namespace monolith {

class LiquidPreconditioner {
 public:
  // The problem and the compressed operator, with the fields that its construction gives besides, must outlive the
  // preconditioner.
  void set(const StepProblem& problem, const FaceBlocks<float>& faces, const CellBlocks<float>& cells,
           FaceField<float>&& transfer, FaceField<float>&& conductance);

  // x ~ the solution for right side r: U by components, then p^, lattice.size each. Halos of x are filled, those of r not read.
  void apply(const float* r, float* x);

  std::size_t bytes() const { return velocity_.bytes() + pressure_.bytes() + g_.size() * sizeof(float); }

 private:
  const StepProblem* problem_ = nullptr;
  const FaceBlocks<float>* faces_ = nullptr;
  const CellBlocks<float>* cells_ = nullptr;
  VelocityMultigrid velocity_;
  PressureMultigrid pressure_;
  std::vector<float> g_;
};

}  // namespace monolith
