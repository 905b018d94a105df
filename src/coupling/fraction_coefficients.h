#pragma once
// The discretisation `fractions`, that of the paper (step_problem.h): all boundaries by volume fractions, none fitted.
//
// With the combined velocity of a face, uc = W_F u + sum_i W_Si Q_i^T v_i, a step minimises
//   1/(2 dt) rho |u - u*|^2 weighted W_F^u W_L^u + eta |D uc|^2 weighted W_L^s W_F^s,
// where G^T uc = 0 in cells with liquid.
// The unknown of a face is U = W_F u, the flux-weighted velocity, in which D and G^T have no weights left:
//   mass   W_L^u / W_F^u               open    1
//   normal 2 N W_L^s W_F^s             shear   sqrt(N W_L^s W_F^s), both factors       (N as in stokes_coefficients.h)
//   J_p    sum over a cell's faces of differences of W_Si            divergence rows
//   J_s    differences of W_Si Q_i^T over a stress sample            normal and shear rows
// and the multiplier p^ is W_L^p p. Symmetric, positive semi-definite. There is neither drag nor sticking liquid.
//
// Surface: W_L from the level set (liquid_fractions.h). A face with W_L = 0 that is open has no inertia, so no pressure
// difference can stand across it: a cell next to one is at the pressure of the air and carries none of its own. A flat
// surface at any height is at rest, with p^ the pressure at the cell's centre. Measured on a sloshing wave (32 x 8
// cells, amplitude 0.3 cells, six depths): period 1.7 % off on average, with the ghost fluid of `fitted` 2.4 %; where
// the surface crosses the cells' middles a quarter of the amplitude is lost in 3.5 periods, with the ghost fluid a
// tenth.
//
// Two kinds of faces have an unknown but no velocity worth the name; it is taken from the faces around or, in a body,
// from that (StepProblem::isResolved):
// - Hardly open ones. Less than 1e-3 is closed and given to the bodies. Of the rest the flux U is well determined,
//   U/W_F is not: W_F^s leaves the liquid of a sliver free to slip, and if advected it gathers speed (16 m/s in a
//   liquid of 30 Pa s that moves at 1). Closing more of them instead (W_F < 0.05, 0.1) costs buoyancy, +0.3 and +0.6 %
//   of a sphere at D/h = 8 in place of +0.1 %, and leaves 6 m/s.
// - Those between cells without pressure. Nothing accelerates them with the liquid below, and when the surface rises
//   they would mix what they were into it: without this rule the wave above loses three quarters of its amplitude.

#include <vector>

#include "coupling/body_rows.h"
#include "coupling/liquid_fractions.h"
#include "coupling/stokes_coefficients.h"
#include "coupling/stress_fractions.h"

namespace monolith {

struct FractionGeometry {
  FaceField<double> fluid;  // W_F^u
  StressFractions stress;   // W_F^s; empty without viscosity
  LiquidFractions liquid;
};

FractionGeometry sampleFractions(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                 const SolidFractions& solids, const std::vector<double>& liquid_distance,
                                 bool viscous);

// Coefficients of one level; `viscous_number` is that of the level. `strain`, if wanted, is filled only with viscosity.
void buildFractionCoefficients(const Lattice& lattice, const FractionGeometry& geometry, double viscous_number,
                               StaggeredCoefficients<double>& out, StrainScales* strain = nullptr);

// Rows of the bodies on the finest level. What lies deep inside a body cancels and is not stored.
void buildFractionRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                       const StaggeredCoefficients<double>& coefficients, BodyRows& out);

// The coarser levels, in the multigrid's precision: the same construction on averaged geometry; none below a level
// whose viscous number is least_number or less.
void buildCoarseFractionLevels(const Lattice& lattice, const FractionGeometry& geometry,
                               const std::vector<double>& liquid_distance, double viscous_number, double least_number,
                               std::vector<StaggeredCoefficients<float>>& levels);

}  // namespace monolith
