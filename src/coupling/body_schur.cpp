#include "coupling/body_schur.h"

namespace monolith {

Eigen::MatrixXd BodySchur::resistance(const Lattice& lattice, const BodyColumns<float>& columns,
                                      const Eigen::SparseMatrix<double>& S, LiquidPreconditioner& preconditioner) {
  const Eigen::Index n = S.cols();
  if (n == 0) return Eigen::MatrixXd(0, 0);
  Eigen::MatrixXd R = S.transpose() * columns.ownResistance() * S;
  std::vector<float> push(4 * lattice.size), answer(push.size(), 0.0f);
  const LiquidFields<float> push_fields = packedFields(lattice, push.data());
  const LiquidFields<const float> answer_fields = packedFields<const float>(lattice, answer.data());
  for (Eigen::Index column = 0; column < n; ++column) {
    std::fill(push.begin(), push.end(), 0.0f);
    const Eigen::VectorXf motion = -Eigen::VectorXd(S.col(column)).cast<float>();
    columns.addMotion(motion.data(), push_fields);
    preconditioner.apply(push.data(), 1.0f, answer.data());
    // The liquid's answer and the motion itself act on the bodies together.
    R.col(column) += S.transpose() * columns.forces(answer_fields);
  }
  const Eigen::MatrixXd symmetric = 0.5 * (R + R.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace monolith
