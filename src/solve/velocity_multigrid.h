#pragma once
// One geometric multigrid V-cycle for the viscous block of the momentum equation, in single precision: a preconditioner,
// not a solver. Chebyshev smoothing; the coarse operators are given, one StaggeredCoefficients a level. A face that is
// tied to a solid has no coarse counterpart as stiff as itself: in both transfers it counts by its free share,
// 1 - tie/diagonal, and the smoother does the rest.

#include <vector>

#include "solve/chebyshev.h"
#include "solve/staggered_operator.h"

namespace monolith {

class VelocityMultigrid {
 public:
  // Levels from fine to coarse, each coarsened() of the one before; the first `count` are used and must outlive the multigrid.
  void setLevels(const std::vector<StaggeredCoefficients<float>>& levels, std::size_t count);

  // x = approximate solution of A x = b. Halos of b need not be filled; x's halo is zero.
  void cycle(const FaceField<float>& b, FaceField<float>& x);

 private:
  struct Level {
    const StaggeredCoefficients<float>* c = nullptr;
    FaceField<float> inverse_diagonal, x, b, r, d;
    FaceField<float> transfer;  // share of a face's correction that comes from the coarser level
    StressSamples<float> stress;
    ChebyshevRange range;
  };

  void smooth(Level& level, int degree, bool from_zero);
  void residual(Level& level);
  void apply(Level& level, FaceField<float>& x, FaceField<float>& Ax);
  void descend(std::size_t index);

  std::vector<Level> levels_;
};

}  // namespace monolith
