#include "coupling/solve_status.h"

namespace monolith {

const char* toString(SolveStatus status) {
  switch (status) {
    case SolveStatus::kNotRun:
      return "not run";
    case SolveStatus::kConverged:
      return "converged";
    case SolveStatus::kNotConverged:
      return "not converged";
    case SolveStatus::kInconsistent:
      return "inconsistent";
  }
  return "unknown";
}

}  // namespace monolith
