#pragma once
// Projection preconditioner of the liquid's own block [A_uu, -C^T; -C, 0], in single precision.

#include <vector>

#include "coupling/pressure_regions.h"
#include "coupling/step_operator.h"
#include "solve/pressure_multigrid.h"
#include "solve/velocity_multigrid.h"

namespace monolith {

class LiquidPreconditioner {
 public:
  // levels[0] is the finest. `regions` must outlive the preconditioner, and so must `cell_viscosity`, the factors of the
  // viscous number in each cell; empty: one.
  void set(std::vector<StaggeredCoefficients<float>>&& levels, double viscous_number,
           const std::vector<float>* cell_viscosity, const std::vector<PressureRegion>* regions);
  std::vector<StaggeredCoefficients<float>> takeLevels() { return std::move(levels_); }

  // x ~ the solution for right side r; the bodies' parts are neither read nor written.
  void apply(const StepVector& r, StepVector& x);

 private:
  std::vector<StaggeredCoefficients<float>> levels_;
  float viscous_number_ = 0.0f;
  const std::vector<float>* cell_viscosity_ = nullptr;
  const std::vector<PressureRegion>* regions_ = nullptr;
  VelocityMultigrid velocity_;
  PressureMultigrid pressure_;
  FaceField<float> b_, u_;
  std::vector<float> g_, phi_;
};

}  // namespace monolith
