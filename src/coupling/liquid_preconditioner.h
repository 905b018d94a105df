#pragma once
// Preconditioner of the liquid's own block [A, -C^T; -C, 0], in single precision. Linear: the same map on every call.
//
//   u* = A^-1 r_u                        one multigrid cycle
//   g = -r_p - C u*
//   p = L^-1 g + w g                     one multigrid cycle on L = C K C^T; Cahouet & Chabard (1988)
//   u = u* + K C^T L^-1 g                the projection method (Griffith 2009; Cai et al. 2014)
//
// w = 2 N times the part of the cell's normal stress that is in the liquid: next to a free surface the Schur complement
// is as much softer. K is the impulse of a face: its open part over its mass and what ties it to solids; without
// viscosity all this is exact. From kLeastHolding on it follows the permeability (permeability.h), which keeps
// iterations from growing with N; the waves that are left to L are long then, and its finest level is smoothed at
// boundaries alone.

#include <vector>

#include "coupling/permeability.h"
#include "coupling/step_problem.h"
#include "solve/pressure_multigrid.h"
#include "solve/velocity_multigrid.h"

namespace monolith {

class LiquidPreconditioner {
 public:
  // The problem and the compressed operator, with the fields that its construction gives besides, must outlive the
  // preconditioner.
  void set(const StepProblem& problem, const FaceBlocks<float>& faces, const CellBlocks<float>& cells,
           const FaceRows<float>& transfer, const FaceRows<float>& impulse);

  // x ~ the solution for right side r, its flux times flux_scale: U by components, then p^, lattice.size each. Halos of
  // x are filled, those of r not read.
  void apply(const float* r, float flux_scale, float* x);

 private:
  const StepProblem* problem_ = nullptr;
  const FaceBlocks<float>* faces_ = nullptr;
  const CellBlocks<float>* cells_ = nullptr;
  VelocityMultigrid velocity_;
  PressureMultigrid pressure_;
  Permeability permeability_;
  const FaceRows<float>* impulse_ = nullptr;  // K
  std::vector<float> g_, weight_;
  long build_ = -1;  // of the cells' blocks, that g_ has followed
};

}  // namespace monolith
