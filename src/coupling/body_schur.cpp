#include "coupling/body_schur.h"

namespace monolith {

Eigen::MatrixXd BodySchur::resistance(StepOperator& op, LiquidPreconditioner& preconditioner, const Lattice& lattice,
                                      std::size_t body_count, const std::vector<int>& free) {
  const auto n = static_cast<Eigen::Index>(6 * free.size());
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
  if (n == 0) return R;
  StepVector x, y;
  x.resize(lattice, body_count);
  std::vector<Vector6d> forces(body_count);
  for (Eigen::Index column = 0; column < n; ++column) {
    x.setZero();
    x.bodies[free[column / 6]][column % 6] = -1.0;
    op.apply(x, y);  // minus the column of the coupling blocks
    preconditioner.apply(y, x);
    // The liquid's answer and the motion itself act on the bodies together.
    op.bodyForces(x, forces);
    for (std::size_t b = 0; b < free.size(); ++b) R.block<6, 1>(6 * b, column) = forces[free[b]] - y.bodies[free[b]];
    x.bodies[free[column / 6]][column % 6] = 0.0;
  }
  const Eigen::MatrixXd symmetric = 0.5 * (R + R.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace monolith
