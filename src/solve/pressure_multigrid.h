#pragma once
// One geometric multigrid V-cycle for the pressure block L = C mass^-1 C^T with the effective mass of
// staggered_operator.h, a seven-point operator, in single precision.
//
// L is a network: conductance open^2/mass on every face between two cells with pressure, and towards the air, where the
// pressure is zero. A coarse face takes the mean of the four fine ones that it consists of (aggregation, Braess 1995,
// with the factor that makes it consistent), so cut cells, thin gaps and the free surface coarsen without geometry.

#include <vector>

#include "solve/chebyshev.h"
#include "solve/staggered_operator.h"

namespace monolith {

class PressureMultigrid {
 public:
  // The network of the finest level; the coarser ones follow from it.
  void set(const StaggeredCoefficients<float>& fine);

  // Effective mass of the faces of the finest level.
  const FaceField<float>& mass() const { return mass_; }

  // x = approximate solution of L x = b.
  void cycle(const std::vector<float>& b, std::vector<float>& x);

 private:
  enum Kind : std::uint8_t { kOutside, kLiquid, kAir };

  struct Level {
    Lattice lattice;
    FaceField<float> conductance;      // between cells with pressure
    std::vector<float> to_air;         // per cell, sum over its faces
    std::vector<std::uint8_t> kind;
    std::vector<float> inverse_diagonal, x, b, r, d;
    ChebyshevRange range;
  };

  void coarsen(const Level& fine, Level& coarse) const;
  void finish(Level& level) const;
  void extend(Level& level) const;
  void residual(Level& level);
  void smooth(Level& level, int degree, bool from_zero);
  void descend(std::size_t index);

  FaceField<float> mass_;
  std::vector<Level> levels_;
};

}  // namespace monolith
