#pragma once
// Small dense linear complementarity problem with a symmetric positive definite matrix:
//   find x >= 0 with w = M x + q >= 0 and x . w = 0.
// Block principal pivoting with Murty's least-index rule as the fallback that ends for sure (Judice & Pires 1994,
// Comput. Oper. Res. 21, 587).

#include <Eigen/Dense>
#include <vector>

namespace monolith {

struct LcpReport {
  bool solved = false;
  int pivots = 0;
  std::vector<char> active;  // x may be positive
};

[[nodiscard]] LcpReport solveLcp(const Eigen::Ref<const Eigen::MatrixXd>& M, const Eigen::VectorXd& q,
                                 Eigen::VectorXd& x);

}  // namespace monolith
