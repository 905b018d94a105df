#pragma once
// Small dense quadratic program over a product of discs, the friction problem of a step with the normal impulses given
// (maximal dissipation, Kaufman et al. 2008):
//   min 1/2 f^T A f + q^T f    subject to |f_c| <= radius_c,   f_c = (f[2c], f[2c+1]),  A symmetric positive definite.
// Block Gauss-Seidel with the exact minimiser over each disc.

#include <Eigen/Dense>
#include <vector>

namespace monolith {

// Minimiser of 1/2 x^T B x + g^T x over |x| <= radius, for symmetric positive definite B.
class DiscMinimiser {
 public:
  explicit DiscMinimiser(const Eigen::Matrix2d& B);
  Eigen::Vector2d minimise(const Eigen::Vector2d& g, double radius) const;

 private:
  Eigen::Matrix2d vectors_;
  Eigen::Vector2d values_;
};

struct DiscQpReport {
  bool solved = false;
  int sweeps = 0;
};

class DiscQp {
 public:
  // A must outlive it.
  explicit DiscQp(const Eigen::Ref<const Eigen::MatrixXd>& A);
  // f: start on entry, minimiser on return. Ends when a sweep changes A f (velocities) by no more than tolerance * max
  // |q|: of redundant contacts the impulses themselves are not determined.
  [[nodiscard]] DiscQpReport solve(const Eigen::VectorXd& q, const Eigen::VectorXd& radius, double tolerance,
                                   int maximum_sweeps, Eigen::VectorXd& f) const;

 private:
  Eigen::Ref<const Eigen::MatrixXd> A_;
  std::vector<DiscMinimiser> discs_;
};

}  // namespace monolith
