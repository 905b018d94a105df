#pragma once
// Small dense quadratic program over a product of discs, the friction problem of a step with the normal impulses given
// (maximal dissipation, Kaufman et al. 2008):
//   min 1/2 f^T A f + q^T f    subject to |f_c| <= radius_c,   f_c = (f[2c], f[2c+1]),  A symmetric positive definite.
// Block Gauss-Seidel with the exact minimiser over each disc.

#include <Eigen/Dense>

namespace monolith {

struct DiscQpReport {
  bool solved = false;
  int sweeps = 0;
};

// Minimiser of 1/2 x^T B x + g^T x over |x| <= radius, for symmetric positive definite B.
Eigen::Vector2d minimiseOverDisc(const Eigen::Matrix2d& B, const Eigen::Vector2d& g, double radius);

// f: start on entry, minimiser on return. Ends when a sweep changes A f (velocities) by no more than tolerance * max |q|:
// of redundant contacts the impulses themselves are not determined.
[[nodiscard]] DiscQpReport solveDiscQp(const Eigen::MatrixXd& A, const Eigen::VectorXd& q, const Eigen::VectorXd& radius,
                                       double tolerance, int maximum_sweeps, Eigen::VectorXd& f);

}  // namespace monolith
