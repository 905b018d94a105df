#pragma once
// A step in the form of the paper that step_problem.h names: unknowns x = (s, p), stress and pressure, with the
// velocities eliminated,
//
//   M U   + G^T x = f_u          G = (D; -C)      per face
//   M_S v + J^T x = f_v          J = (J_s; -C_v)  per free body
//   G U + J v - W^-1 x = b       W^-1 = 0 and b = the prescribed flux in the rows of p, b = 0 in those of s
//   ->  [ A + J M_S^-1 J^T ] x = G M^-1 f_u + J M_S^-1 f_v - b,    A = G M^-1 G^T + W^-1
//
// assembled as sparse matrices from the coefficients that the matrix-free operator uses. Symmetric, positive
// semi-definite: a sealed region leaves its pressure free up to a constant.

#include <Eigen/Sparse>
#include <vector>

#include "coupling/step_problem.h"

namespace monolith {

struct StressSystem {
  using Sparse = Eigen::SparseMatrix<double>;

  struct Face {
    int axis = 0;
    std::ptrdiff_t at = 0;
  };

  explicit StressSystem(const StepProblem& problem);

  Eigen::Index unknowns() const { return A.rows(); }
  // f_u of a right side, and its (0; flux).
  Eigen::VectorXd faceForces(const StepVector& rhs) const;
  Eigen::VectorXd flux(const StepVector& rhs) const;
  // U and p of x into fields (the bodies' twists are left alone).
  void velocityAndPressure(const Eigen::VectorXd& x, const Eigen::VectorXd& face_forces, StepVector& out) const;
  // p into x; the stress that U and v of `from` imply.
  Eigen::VectorXd unknownsOf(const StepVector& from, const Eigen::VectorXd& free_twists) const;

  std::vector<Face> faces;
  std::vector<std::ptrdiff_t> pressure_cells;  // of the last unknowns
  Eigen::Index stresses = 0;                   // number of the first
  Sparse G;                                    // unknowns x faces
  Eigen::VectorXd inverse_mass;                // per face
  Eigen::VectorXd inverse_weight;              // per unknown; 0 for pressures
  Sparse J;                                    // unknowns x those of the bodies
  Sparse A;
};

}  // namespace monolith
