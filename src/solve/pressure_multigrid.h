#pragma once
// One geometric multigrid V-cycle for the pressure block L = C K C^T, K the impulse of a face
// (liquid_preconditioner.h), a seven-point operator, in single precision. Linear: the same map on every call.
//
// L is a network: conductance open^2 K on every face between two cells with pressure, and towards the air, where the
// pressure is zero. A coarse face takes the mean of the four fine ones that it consists of (aggregation, Braess 1995,
// with the factor that makes it consistent), so cut cells, thin gaps and the free surface coarsen without geometry; the
// conductance to the air follows the surface's distance to the centre of the coarse cell.
//
// Where viscosity rules, the answer for waves as short as a few cells doesn't matter away from boundaries: there the
// finest level may be left to the coarser ones.

#include <Eigen/Dense>
#include <vector>

#include "solve/chebyshev.h"
#include "solve/staggered_operator.h"
#include "solve/stencil_blocks.h"

namespace monolith {

class PressureMultigrid {
 public:
  // The network of the finest level: conductance fluid * impulse at each face, halos filled; no impulse where there is
  // no unknown. The coarser ones follow from it. steady: rows in which nothing has changed since the last call.
  // smoothed: cells that are smoothed on the finest level, the others only take what the coarser ones have found; null:
  // all.
  void set(const Lattice& lattice, const std::vector<std::uint8_t>& has_pressure, const FaceField<double>& fluid,
           const FaceRows<float>& impulse, const SteadyRows* steady = nullptr,
           const std::vector<std::uint8_t>* smoothed = nullptr);

  // The next set() takes no row for steady.
  void distrust() {
    if (!levels_.empty()) levels_[0].blocks.distrust();
  }

  // Approximate solution x of L x = b, zero outside of cells with pressure; its halo is filled. It may be changed in
  // place and is valid until the next call.
  float* cycle(const float* b);

 private:
  enum Kind : std::uint8_t { kOutside, kLiquid, kAir };

  // Places of the coefficients in a cell's pattern: conductances to the air, down and up each axis, 1/diagonal.
  enum : int { kToAir, kLow, kHigh = 4, kInverse = 7, kCount };

  // x[to] = mean of x[a] and x[b]
  struct Extension {
    std::int32_t to, a, b;
  };

  struct Level {
    Lattice lattice;
    StencilBlocks<float, kCount> blocks;
    Planes planes;  // that hold liquid
    std::vector<float> mask, x, next, b, d;
    std::vector<Extension> extension;
    const float* right = nullptr;
    ChebyshevRange range;
    long build = -1;  // of the blocks, that the fields have followed
    bool partial = false;  // blocks are where it is smoothed and next to that
  };
  // What coarsening needs of a level. beyond: cells across the surface, air, also where coarse cells have lost sight of
  // it.
  struct Network {
    FaceField<float> conductances;  // between cells with pressure
    std::vector<float> to_air;      // per cell, sum over its faces
    std::vector<std::uint8_t> kinds, across;

    float conductance(int axis, std::ptrdiff_t face) const { return conductances[axis][face]; }
    float toAir(std::ptrdiff_t cell) const { return to_air[cell]; }
    Kind kind(std::ptrdiff_t cell) const { return static_cast<Kind>(kinds[cell]); }
    bool beyond(std::ptrdiff_t cell) const { return across[cell] != 0; }
    const std::vector<float>& allConductances(int axis, std::vector<float>&) const { return conductances[axis]; }
  };
  // The same of the finest level, where all but the kinds follows from what there is.
  struct FinestNetwork {
    const Lattice& lattice;
    const FaceField<double>& fluid;
    const FaceRows<float>& impulse;
    const std::vector<std::uint8_t>& kinds;

    float whole(int axis, std::ptrdiff_t face) const {
      return static_cast<float>(fluid[axis][face]) * impulse[axis][face];
    }
    bool pressed(std::ptrdiff_t cell) const { return kinds[cell] == kLiquid; }
    float conductance(int axis, std::ptrdiff_t face) const {
      return pressed(face - lattice.stride[axis]) && pressed(face) ? whole(axis, face) : 0.0F;
    }
    float toAir(std::ptrdiff_t cell) const;
    Kind kind(std::ptrdiff_t cell) const { return static_cast<Kind>(kinds[cell]); }
    bool beyond(std::ptrdiff_t cell) const { return kinds[cell] == kAir; }
    const std::vector<float>& allConductances(int axis, std::vector<float>& room) const;
  };

  void findKinds(const Lattice& lattice, const std::vector<std::uint8_t>& has_pressure, const FaceField<double>& fluid,
                 const FaceRows<float>& impulse, const SteadyRows* steady);
  template <class SomeNetwork>
  void coarsen(const Lattice& from, const SomeNetwork& fine, const Lattice& l, Network& coarse) const;
  template <class SomeNetwork>
  void finish(const SomeNetwork& network, const std::vector<std::uint8_t>& kinds, const SteadyRows* steady,
              const std::vector<std::uint8_t>* smoothed, Level& level) const;
  void findExtension(const Network& network, Level& level) const;
  void invert(const Network& network, const Level& level);
  void residual(Level& level, float* r) const;
  void smooth(Level& level, int degree, bool from_zero) const;
  void descend(std::size_t index);

  std::vector<Level> levels_;
  std::vector<std::uint8_t> kinds_;           // of the finest level
  std::vector<std::int32_t> coarsest_cells_;  // if few enough to be solved directly
  Eigen::MatrixXf inverse_;
};

}  // namespace monolith
