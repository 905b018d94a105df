#include "coupling/body_schur.h"

namespace monolith {

Eigen::MatrixXd BodySchur::resistance(const BodyColumns<float>& columns, LiquidPreconditioner& preconditioner,
                                      std::size_t liquid) {
  Eigen::MatrixXd R = columns.ownResistance();
  const Eigen::Index n = R.cols();
  if (n == 0) return R;
  std::vector<float> push(liquid), answer(liquid, 0.0f), motion(n, 0.0f);
  for (Eigen::Index column = 0; column < n; ++column) {
    std::fill(push.begin(), push.end(), 0.0f);
    motion[column] = -1.0f;
    columns.addMotion(motion.data(), push.data());
    motion[column] = 0.0f;
    preconditioner.apply(push.data(), 1.0f, answer.data());
    // The liquid's answer and the motion itself act on the bodies together.
    R.col(column) += columns.forces(answer.data());
  }
  const Eigen::MatrixXd symmetric = 0.5 * (R + R.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace monolith
