#pragma once
// Flexible GMRES (Saad 1993, SIAM J. Sci. Comput. 14, 461), right preconditioned, inside iterative refinement: the
// residual b - A x is formed in double precision at each restart, the correction is found in single precision on vectors
// half as wide. Keeping the directions P^-1 v beside the basis costs memory and pays: the operator sees their rounding,
// where a correction P^-1 (V y) formed at the end carries that of a large, smooth pressure into the solution. Minimises
// |b - A x|_2 over each cycle; the residual that it reports is the recomputed one.

#include <Eigen/Dense>
#include <functional>
#include <vector>

namespace monolith {

struct KrylovOptions {
  double absolute_tolerance = 0.0;  // on |b - A x|_2
  int maximum_iterations = 200;
  int restart = 60;  // directions kept; memory grows only as they are used
};

struct KrylovReport {
  bool converged = false;
  int iterations = 0;
  double initial_residual = 0.0;
  double residual = 0.0;  // |b - A x|_2, recomputed
};

// What is to be solved. x may be changed where that doesn't change A x (halos).
struct KrylovMaps {
  std::function<void(std::vector<double>& x, std::vector<double>& y)> apply;
  std::function<void(std::vector<float>& x, std::vector<float>& y)> apply_single;
  std::function<void(std::vector<float>& x, std::vector<float>& y)> precondition;
};

class Fgmres {
 public:
  // x holds the initial guess on entry, the solution on return. Work space is kept between calls.
  [[nodiscard]] KrylovReport solve(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x,
                                   const KrylovOptions& options);

  std::size_t bytes() const;

 private:
  double residual(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x);
  // One cycle on the residual in work_, until it is `goal` times as large; returns the coefficients of the directions.
  Eigen::VectorXd cycle(const KrylovMaps& maps, double norm, double goal, int most);

  std::vector<std::vector<float>> basis_;       // V
  std::vector<std::vector<float>> directions_;  // Z = P^-1 V
  std::vector<double> work_;
};

}  // namespace monolith
