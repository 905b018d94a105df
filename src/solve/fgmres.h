#pragma once
// Flexible GMRES (Saad 1993, SIAM J. Sci. Comput. 14, 461), right preconditioned, restarted: solves A x = b where the
// preconditioner may change from one iteration to the next. Minimises |b - A x|_2, so the residual that it reports
// is the true one; it is recomputed at each restart and at the end.

#include <functional>
#include <vector>

namespace monolith {

struct KrylovOptions {
  double absolute_tolerance = 0.0;  // on |b - A x|_2
  int maximum_iterations = 200;
  int restart = 80;  // directions kept; memory grows only as they are used
};

struct KrylovReport {
  bool converged = false;
  int iterations = 0;
  double initial_residual = 0.0;
  double residual = 0.0;  // |b - A x|_2, recomputed
};

using LinearMap = std::function<void(const std::vector<double>& x, std::vector<double>& y)>;

class Fgmres {
 public:
  // x holds the initial guess on entry, the solution on return. Work space is kept between calls.
  [[nodiscard]] KrylovReport solve(const LinearMap& apply, const LinearMap& precondition,
                                   const std::vector<double>& b, std::vector<double>& x,
                                   const KrylovOptions& options);

 private:
  std::vector<std::vector<double>> basis_;      // V
  std::vector<std::vector<double>> directions_; // Z = P^-1 V
  std::vector<double> work_;
};

}  // namespace monolith
