#pragma once
// The discretisation `fractions`, the paper's own (DESIGN 1.1, 1.2): every boundary by volume fractions, nothing fitted.
//
// With the combined velocity of a face, uc = W_F u + sum_i W_Si Q_i^T v_i, a step minimises
//   1/(2 dt) rho |u - u*|^2 weighted W_F^u W_L^u + eta |D uc|^2 weighted W_L^s W_F^s,  where G^T uc = 0 in cells with liquid.
// The unknown of a face is U = W_F u, the flux-weighted velocity, in which D and G^T have no weights left:
//   mass   W_L^u / W_F^u               open    1
//   normal 2 N W_L^s W_F^s             shear   sqrt(N W_L^s W_F^s), both factors       (N as in stokes_coefficients.h)
//   J_p    sum over a cell's faces of differences of W_Si            divergence rows
//   J_s    differences of W_Si Q_i^T over a stress sample            normal and shear rows
// and the multiplier p^ is W_L^p p. Symmetric, positive semi-definite. There is neither drag nor sticking liquid.
//
// Surface: W_L from the level set (liquid_fractions.h). A face with W_L = 0 that is open has no inertia, so no pressure
// difference can stand across it: a cell next to one is at the pressure of the air and carries none of its own. A flat
// surface at any height is at rest, with p^ the pressure at the cell's centre.

#include <vector>

#include "coupling/body_rows.h"
#include "coupling/liquid_fractions.h"
#include "coupling/stress_fractions.h"

namespace monolith {

struct FractionGeometry {
  FaceField<double> fluid;  // W_F^u
  StressFractions stress;   // W_F^s; empty without viscosity
  LiquidFractions liquid;
};

// Gives what is open of nearly closed faces to the bodies there: u = U/W_F must not magnify what D leaves of U.
void closeSlivers(const MacGrid& grid, SolidFractions& solids);

FractionGeometry sampleFractions(const MacGrid& grid, const std::vector<RigidBody>& bodies, const SolidFractions& solids,
                                 const std::vector<double>& liquid_distance, bool viscous);

// Coefficients of one level; `viscous_number` is that of the level.
void buildFractionCoefficients(const Lattice& lattice, const FractionGeometry& geometry, double viscous_number,
                               StaggeredCoefficients<double>& out);

// Rows of the bodies on the finest level. What lies deep inside a body cancels and is not stored.
void buildFractionRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                       const StaggeredCoefficients<double>& coefficients, BodyRows& out);

// The coarser levels, in the multigrid's precision: the same construction on averaged geometry.
void buildCoarseFractionLevels(const Lattice& lattice, const FractionGeometry& geometry,
                               const std::vector<double>& liquid_distance, double viscous_number,
                               std::vector<StaggeredCoefficients<float>>& levels);

}  // namespace monolith
