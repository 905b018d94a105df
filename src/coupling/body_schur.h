#pragma once
// How much the liquid resists the motion of the free bodies, seen through one preconditioner cycle:
//   R ~ A_vv - M - [A_vu, -C_v^T] F^-1 [A_uv; -C_v],   6n x 6n, symmetric positive semi-definite.
// Added mass and viscous resistance in one matrix; it steers the solve, and never decides its answer.

#include <Eigen/Dense>
#include <vector>

#include "coupling/liquid_preconditioner.h"
#include "coupling/step_operator.h"

namespace monolith {

class BodySchur {
 public:
  // Columns for the bodies in `free`, in that order, in the units of StepVector.
  static Eigen::MatrixXd resistance(StepOperator& op, LiquidPreconditioner& preconditioner, const Lattice& lattice,
                                    std::size_t body_count, const std::vector<int>& free);
};

}  // namespace monolith
