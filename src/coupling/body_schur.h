#pragma once
// How much the liquid resists the motion of the free bodies, seen through one preconditioner cycle:
//   R ~ S^T (A_vv - M - [A_vu, -C_v^T] F^-1 [A_uv; -C_v]) S,   symmetric positive semi-definite.
// Added mass and viscous resistance in one matrix; it steers the solve, and never decides its answer.

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "coupling/body_columns.h"
#include "coupling/liquid_preconditioner.h"

namespace monolith {

class BodySchur {
 public:
  // S: from the unknowns to the twists, in the units of the columns.
  static Eigen::MatrixXd resistance(const Lattice& lattice, const BodyColumns<float>& columns,
                                    const Eigen::SparseMatrix<double>& S, LiquidPreconditioner& preconditioner);
};

}  // namespace monolith
