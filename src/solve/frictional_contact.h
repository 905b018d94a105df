#pragma once
// Impulses that obey Coulomb's law at all contacts of a small dense system (coulomb_law.h), by what is cheapest first:
// Newton's method from the start that is given, staggered projections, an interior point method, sweeps over the
// contacts.

#include "solve/coulomb_law.h"

namespace monolith {

// Contacts at the edge of what can be may leave the law short of its tolerance: a residual up to this is accepted, and
// reported.
constexpr double kAcceptableLaw = 1e-3;

struct FrictionReport {
  bool solved = false;
  int iterations = 0;     // of all methods
  double residual = 0.0;  // of the law, relative to the largest velocity of w0

  bool acceptable() const { return solved || residual <= kAcceptableLaw; }
};

// r: start on entry, such as the last step's impulses; on return the solution or, unsolved, what came closest to it.
[[nodiscard]] FrictionReport solveFrictionalContact(const FrictionProblem& problem, double tolerance,
                                                    Eigen::VectorXd& r);

}  // namespace monolith
