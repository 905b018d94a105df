#pragma once
// One geometric multigrid V-cycle for the viscous block of the momentum equation, in single precision: a
// preconditioner, not a solver. Chebyshev smoothing; the coarse operators are given, one StaggeredCoefficients a level.
// A face that is tied to a solid has no coarse counterpart as stiff as itself: in both transfers it counts by its free
// share, 1 - tie/diagonal, and the smoother does the rest. Linear: the same map on every call.

#include <vector>

#include "solve/chebyshev.h"
#include "solve/stokes_stencil.h"

namespace monolith {

// Viscous number of a level up to which its mass term dominates and one smoothing sweep is a solve: it needs no coarser
// one.
constexpr double kLeastCoarsenedNumber = 0.05;

class VelocityMultigrid {
 public:
  // The finest level with its transfer weights, and the levels below it: coarse[1] to coarse[count - 1], each
  // coarsened() of the one before. `fine` and `transfer` must outlive the multigrid. generation: of the coarse levels,
  // which are what they were if it is the last one. smoother_degree: Chebyshev steps before and after.
  void set(const Lattice& lattice, const FaceBlocks<float>& fine, const FaceRows<float>& transfer,
           const std::vector<StaggeredCoefficients<float>>& coarse, std::size_t count, long generation,
           int smoother_degree);
  // Approximate solution x of A x = b. x is zero where there is no unknown, before and after; its halo is filled.
  void cycle(const Faces<const float>& b, const Faces<float>& x);
  // The same from the level below the finest on, of which there must be one.
  void coarseCycle(const FaceField<float>& b, FaceField<float>& x);

 private:
  struct Level {
    Lattice lattice;
    FaceBlocks<float> own;
    const FaceBlocks<float>* blocks = nullptr;
    FaceRows<float> own_transfer;
    FaceField<float> own_x, own_next, b, d;  // own_x: of coarse levels
    const FaceRows<float>* transfer = nullptr;
    ChebyshevRange range;
    Faces<const float> right{};
    // Of a cycle: an iterate and the next take turns.
    Faces<float> x{}, next{};
    long generation = -1;  // of a coarse level
    long build = -1;       // of the finest level's blocks, that its fields have followed
  };

  void smooth(Level& level, int degree, bool from_zero);
  void descend(std::size_t index);
  // A cycle from level `index` on, whose solution is in x.
  void cycleFrom(std::size_t index, const Faces<const float>& b, const Faces<float>& x);

  std::vector<Level> levels_;
  int degree_ = 2;
};

}  // namespace monolith
