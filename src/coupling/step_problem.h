#pragma once
// One step of T. Takahashi, C. Batty, 'Monolith: A Monolithic Pressure-Viscosity-Contact Solver for Strong Two-Way
// Rigid-Rigid Rigid-Fluid Coupling', ACM TOG 39(6), 2020 ("the paper" wherever one is named without its own title):
//
//   min over u, v   rho h^3/(2 dt) |u - u*|^2 + 1/(2 dt) (v - v*)^T M (v - v*) + h^3 eta |D uc|^2
//   subject to      G^T uc = 0,   J v >= -gap/dt                   uc: combined velocity of liquid and bodies
//
// (norms over the liquid's part of the control volumes) as a linear system, whichever way it is solved. The paper
// eliminates the velocities (stress_system.h), here it is the stress: liquid velocity U, twists v of the free bodies,
// pressure p,
//
//   [ A_uu  A_uv  -C_u^T ] [ U  ]   [ m U*                  ]
//   [ A_vu  A_vv  -C_v^T ] [ v  ] = [ M v* + J^T r          ]     A = mass + D^T W D over (U, v)
//   [ -C_u  -C_v         ] [ p^ ]   [ flux that is prescribed ]
//
// in the units of coupling/stokes_coefficients.h; bodies by M^ = M/(rho h^3). Symmetric, indefinite. r are the impulses
// of the contacts, J their Jacobian (coupling/contact_rows.h). Liquid that sticks to a body counts in its inertia
// (coupling/sticking_liquid.h). Bodies that joints connect have other unknowns in place of their twists
// (coupling/body_coordinates.h); resistance of the joints is part of M^.

#include <string>
#include <vector>

#include "coupling/body_coordinates.h"
#include "coupling/coarse_levels.h"
#include "coupling/enclosed_rows.h"
#include "coupling/pressure_regions.h"
#include "coupling/solid_fractions.h"
#include "coupling/step_operator.h"
#include "coupling/stokes_coefficients.h"
#include "rigid/integration.h"

namespace monolith {

class StepProblem {
 public:
  explicit StepProblem(const MacGrid& grid, Discretisation discretisation = Discretisation::kFitted)
      : grid(grid), discretisation(discretisation) {}

  // Geometry and material; liquid_distance in cell widths with its halo filled. Bodies must outlive the problem; in
  // `solids` the liquid that sticks to the bodies is moved to them. With `rates`, `strain` is filled, too.
  void assemble(SolidFractions& solids, const std::vector<RigidBody>& all_bodies,
                const std::vector<double>& liquid_distance, double density, double viscosity, double step,
                bool rates = false);

  // The right side with r = 0, and `given`. free_velocity: u*, gravity included; its memory becomes that of
  // rhs.velocity. free_twists: v* of free bodies, the prescribed twist of the others. gravity acts on the liquid that
  // sticks to bodies. Returns what is wrong, if there is no solution: a sealed region whose volume the prescribed
  // motions would change.
  [[nodiscard]] std::string rightSide(FaceField<double> free_velocity, const std::vector<Vector6d>& free_twists,
                                      const Eigen::Vector3d& gravity, StepVector& rhs);

  // y = operator * x, inertia of the free bodies included; rows of the other bodies are zero, and so are the halos.
  void apply(StepVector& x, StepVector& y) const;

  // Wrench of the liquid on every body (mean over the step, at its centre of mass) and largest divergence (1/s), of a
  // solution x that holds the twists of all bodies. work: a field that the divergence of every cell may be written to.
  void results(StepVector& x, const Eigen::Vector3d& gravity, std::vector<Wrench>& liquid, double& divergence,
               std::vector<double>& work) const;

  // Velocity of the liquid (m/s) <-> the unknown U of the face, in place.
  void toUnknowns(FaceField<double>& velocity) const;
  void toVelocities(FaceField<double>& unknowns) const;
  // Whether U of a face tells how fast the liquid there is: such velocities are advected and move the surface; other
  // faces take theirs from around (see fraction_coefficients.h; `fitted`: every face with an unknown).
  bool isResolved(int axis, std::ptrdiff_t face) const {
    return resolved_[axis].empty() ? coefficients.mass[axis][face] > 0.0 : resolved_[axis][face] != 0;
  }
  // The same of the `width` faces from `row` on: 1 or 0.
  void markResolved(int axis, std::ptrdiff_t row, int width, std::uint8_t* resolved) const;
  // Liquid in a face's control volume: (rho h^3) liquidMass() u is its momentum.
  const FaceField<double>& liquidMass() const { return liquid_mass_[0].empty() ? coefficients.mass : liquid_mass_; }

  // Everything is built anew the next time.
  void forget();

  // Those of the bodies' motion; anew after joint_resistance has changed.
  void setUnknowns();

  Eigen::Index bodyUnknowns() const { return coordinates.size(); }
  // M^ of the unknowns, joints' resistance included: S^T M^ S + R.
  Eigen::MatrixXd bodyInertia() const;

  MacGrid grid;
  Discretisation discretisation;
  double sticking_viscosity = 0.0;  // Pa.s, stickingViscosity(), of `fitted`
  bool sticks = false;  // of the last assembly: next to solids the liquid moves as they do; less viscous it slips
  StaggeredCoefficients<double> coefficients;
  BodyRows rows;
  FaceField<double> flux_share;  // U = flux_share u, 0 without an unknown; empty: U = u
  std::vector<PressureRegion> regions;
  SteadyRows steady;         // of the coefficients, since the last assembly
  CoarseLevels coarse;
  const std::vector<RigidBody>* bodies = nullptr;
  double viscous_number = 0.0;        // of the reference viscosity where viscosity varies
  std::vector<float> cell_viscosity;  // relative to it, per cell; empty: constant
  StrainScales strain;
  double impulse_scale = 1.0;   // rho h^3: dimensionless impulse -> N s
  double pressure_scale = 1.0;  // rho h/dt: p^ -> Pa
  double dt = 1.0;
  std::vector<int> free;                 // bodies whose twist is unknown
  BodyCoordinates coordinates;           // the unknowns of their motion
  Eigen::VectorXd unknown_scale;         // of these, as twist_scale of twists
  std::vector<double> joint_resistance;  // of all bodies' joints, N m s^2/rad or N s^2/m: impulse of a step by velocity
  std::vector<Vector6d> given;           // what prescribed motions bring to each body's twist
  std::vector<int> free_index;           // body -> place in `free`, or -1
  std::vector<char> touched;             // by liquid: free bodies
  std::vector<Vector6d> twist_scale;     // of free bodies: sqrt of the inertia that they feel, liquid included
  std::vector<double> radius;            // of free bodies, cells: of a sphere that displaces as much
  std::vector<Matrix6d> inertia;         // M^ of free bodies with the liquid that sticks to them
  std::vector<Matrix6d> stuck_inertia;   // M^ of the liquid that sticks to each body, free or not
  std::vector<Vector6d> stuck_twists;    // that this liquid brings: of the bodies, unless told otherwise
  std::vector<EnclosedWeight> enclosed;  // in contacts, which liquid reaches from their rim

 private:
  void addJointResistance(const std::vector<Vector6d>& twists, std::vector<Vector6d>& impulses) const;
  void assembleFitted(SolidFractions& solids, const std::vector<double>& liquid_distance, bool rates);
  void assembleFractions(const SolidFractions& solids, const std::vector<double>& liquid_distance, bool rates);
  // What the liquid that sticks to a body would move at by itself: it has moved with the body, so its momentum is not
  // that of the face, which is slower.
  Vector6d stickingTwist(std::size_t body, const Eigen::Vector3d& gravity) const;
  // Dimensionless impulse on a body by the weight of the liquid between a contact and its rim.
  Vector6d enclosedImpulse(const EnclosedWeight& weight, const Eigen::Vector3d& gravity) const;
  std::string balanceSealedRegions(std::vector<double>& flux) const;

  FaceKinds kinds_;                                    // `fitted`, with viscosity
  FaceMask resolved_;                                  // empty: every face with an unknown
  FaceField<double> liquid_mass_;                      // empty: the coefficients'
  mutable StepOperator op_;
};

}  // namespace monolith
