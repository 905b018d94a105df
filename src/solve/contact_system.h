#pragma once
// Linear equations for impulses d at some contacts, the others' being none, as the methods for Coulomb's law ask for
// them step after step:
//   T_c (D d)_c + E_c d_c = b_c,   T_c, E_c: 3 x 3, of the normal and the two tangents of contact c
//
// Of contacts that have more rows than their bodies have unknowns D tells nothing that the bodies' response K does not:
// with D = J K J^T + C and M = T C + E what the bodies do is
//   (K^-1 + J^T M^-1 T J) y = J^T M^-1 b,   d = M^-1 (b - T J y)
// (Woodbury 1950; Hager 1989, SIAM Rev. 31, 221). C is small, and that costs as many digits as it has less than K:
// the solution is corrected on its own residual until none is missing.

#include <Eigen/Dense>
#include <vector>

#include "solve/coulomb_law.h"

namespace monolith {

class ContactSystem {
 public:
  // problem must outlive it. turn, own: T and E of each of `contacts`.
  ContactSystem(const FrictionProblem& problem, std::vector<Eigen::Index> contacts, std::vector<Eigen::Matrix3d> turn,
                std::vector<Eigen::Matrix3d> own);

  // b and the solution: three entries for each of `contacts`, normal first. Not finite where there is none.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::Index rows() const { return 3 * static_cast<Eigen::Index>(contacts_.size()); }
  void setDense();
  void setByBodies();
  Eigen::VectorXd solveByBodies(const Eigen::VectorXd& b) const;
  Eigen::Vector3d compliance(Eigen::Index c) const;
  // b less what d makes of it.
  Eigen::VectorXd residual(const Eigen::VectorXd& b, const Eigen::VectorXd& d) const;

  const FrictionProblem& problem_;
  std::vector<Eigen::Index> contacts_;
  std::vector<Eigen::Matrix3d> turn_, own_;
  bool by_bodies_;
  std::vector<Eigen::Matrix3d> inverse_;  // of M, by bodies
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace monolith
