#pragma once
// From geometry to the coefficients of one step (step_problem.h). Everything is made dimensionless: momentum rows
// are multiplied by dt/(rho h^3), pressure is p^ = dt p/(rho h), and viscosity enters as the viscous number
// N = eta dt/(rho h^2).
//
// Glossary, paper -> code
//   W_F^u   open            part of a face's control volume that is not solid
//   W_L^u   (in mass)       part of it, between two cell centres, that is liquid: mass = W_F^u W_L^u
//   W_L^p   has_pressure    cells whose centre lies in the liquid carry a pressure (ghost fluid: p = 0 at the surface)
//   D       normal, shear   fitted gradient: differences across a solid's surface are taken over the liquid's
//                           part theta of the segment, (u - u_solid(x_surface))/(theta h), energy weighted by theta
//   W^s     (in normal, shear)  theta and the liquid part of the stress sample
//   J_p     divergence rows differences of neighbouring W_Si: cancels inside a body
//   J_s     stress rows     what a body's twist adds to a stress sample
//
// A face whose centre is solid but whose control volume is not wholly so ("sliver") has an unknown when the liquid
// slips: inviscid, or so little viscous that a time step does not resolve the film (see sticking_liquid.h for the other
// case). Viscosity then ties it to the solid it lies in (drag).

#include <Eigen/Dense>
#include <vector>

#include "coupling/body_rows.h"
#include "coupling/fitted_segment.h"
#include "coupling/solid_fractions.h"
#include "fluid/mac_grid.h"
#include "rigid/rigid_body.h"
#include "solve/staggered_operator.h"
#include "solve/steady_rows.h"

namespace monolith {

using FaceKinds = std::array<std::vector<FaceKind>, 3>;

// W_L of the segment between two cell centres from the liquid's distance there.
double liquidPart(double distance_low, double distance_high);

struct StokesGeometry {
  const FaceField<double>* fluid = nullptr;          // W_F
  const FaceField<float>* solid_distance = nullptr;  // cell widths
  // In cell widths, negative in liquid, at cell centres, halo filled.
  const std::vector<double>* liquid_distance = nullptr;
  // Solids' distance at cell centres, halo filled: with it segments find curved surfaces where they are; may be
  // missing.
  const std::vector<float>* solid_cell_distance = nullptr;
};

// From what the operator computes at a sample to its rate, in 1/s times the cell width, where the viscosity is the one
// that the coefficients were built with; 0 where there is no sample.
struct StrainScales {
  FaceField<double> normal;  // (U_a[c + a] - U_a[c]) -> D_aa
  FaceField<double> shear;   // t -> 2 D_ab
  FaceField<double> drag;    // slip past the solid -> shear of the film

  void resize(const Lattice& lattice);  // all zero
  void fillHalos(const Lattice& lattice);
};

// Coefficients of one level; `viscous_number` is that of the level. `strain`, if wanted, is filled only with viscosity.
// Of steady rows what is there is kept; not with `strain`. kinds: of the faces, found with viscosity only.
void buildCoefficients(const Lattice& lattice, const StokesGeometry& geometry, double viscous_number,
                       StaggeredCoefficients<double>& out, FaceKinds& kinds, StrainScales* strain = nullptr,
                       const SteadyRows* steady = nullptr);

// Rows of the bodies on the finest level, for coefficients built from the same geometry.
void buildBodyRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                   const StokesGeometry& geometry, const StaggeredCoefficients<double>& coefficients,
                   const FaceKinds& kinds, BodyRows& out);

// The coarser levels, in the multigrid's precision: the same construction on averaged geometry; none below a level
// whose viscous number is least_number or less.
void buildCoarseLevels(const Lattice& lattice, const StokesGeometry& geometry, double viscous_number,
                       double least_number, std::vector<StaggeredCoefficients<float>>& levels);

}  // namespace monolith
