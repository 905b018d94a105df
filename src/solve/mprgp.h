#pragma once
// Modified proportioning with reduced gradient projections (Dostal & Schoeberl 2005, Comput. Optim. Appl. 30, 23),
// preconditioned in face:
//   min 1/2 x^T A x - b^T x   subject to   x_i >= 0 for the last entries,   A symmetric positive semi-definite.

#include <Eigen/Dense>
#include <functional>

namespace monolith {

struct MprgpOptions {
  double tolerance = 1e-8;       // |projected gradient|_2 relative to |b|_2
  int maximum_iterations = 20000;
};

struct MprgpReport {
  bool converged = false;
  int iterations = 0;     // products with A
  double residual = 0.0;  // |projected gradient|_2 / |b|_2, recomputed
};

using VectorMap = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)>;

// The first `unconstrained` entries have no bound; `precondition` acts on them (symmetric positive definite). `norm`:
// upper bound of the largest eigenvalue of A on the others. x: start on entry (made feasible), minimiser on return.
[[nodiscard]] MprgpReport solveMprgp(const VectorMap& apply, const VectorMap& precondition, double norm,
                                     const Eigen::VectorXd& b, Eigen::Index unconstrained, const MprgpOptions& options,
                                     Eigen::VectorXd& x);

}  // namespace monolith
