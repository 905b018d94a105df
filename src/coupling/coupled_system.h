#pragma once
// One step: assemble it (coupling/step_problem.h), solve it by the solver and the coupling that the scene names, and
// hand back velocities, pressure, twists and the forces on the bodies.

#include <memory>
#include <vector>

#include "coupling/contact_rows.h"
#include "coupling/step_solver.h"
#include "coupling/variable_viscosity.h"

namespace monolith {

// In: initial guess. Out: solution, if the report says so; otherwise no solution of anything.
struct CoupledState {
  FaceField<double> velocity;    // m/s, zero where it is not resolved
  std::vector<double> pressure;  // Pa
  std::vector<Vector6d> twists;  // of all bodies
  std::vector<Wrench> liquid;    // mean over the step, on each body
  std::vector<Wrench> contact;
  ContactForces contact_forces;
};

class CoupledSystem {
 public:
  CoupledSystem(const MacGrid& grid, SolverName solver, CouplingName coupling, Discretisation discretisation);
  ~CoupledSystem();

  // stickingViscosity() of the liquid (sticking_liquid.h), from the next assembly on; at first all that is viscous
  // sticks.
  void setStickingViscosity(double viscosity);

  // What the solver has learnt from the steps so far does not count from now on; assemble() has to follow.
  void forget();

  // Geometry and material of the step; liquid_distance in cell widths with its halo filled. Bodies and distance must
  // outlive the solve; in `solids` the liquid that sticks to the bodies is moved to them (sticking_liquid.h).
  void assemble(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                const std::vector<double>& liquid_distance, double density, double viscosity, double dt);

  // The same with a viscosity that varies, `reference` its scale: to be followed by setViscosity() before each solve().
  void assembleVariable(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                        const std::vector<double>& liquid_distance, double density, double reference, double dt);
  // Twists of the liquid that sticks to the bodies before the step, where they are not those of the bodies: these have
  // been set. Until the next assembly.
  void setStuckTwists(const std::vector<Vector6d>& twists);
  // What the law makes of the velocities of a state.
  void evaluateViscosity(const ViscosityLaw& law, const CoupledState& state, ViscosityField& field);
  void setViscosity(const ViscosityField& field);
  // Impulse of a step by velocity of the bodies' joints, N m s^2/rad or N s^2/m; from the next assembly on, or
  // of this one.
  void setJointResistance(const std::vector<double>& resistance);
  void changeJointResistance(const std::vector<double>& resistance);
  // After solve(), of its solution: how much the viscous forces change with that viscosity, relative to |b| as the
  // residual.
  double viscousChange(const CoupledState& solution, const ViscosityField& next);

  // free_velocity: u*, gravity included; used up, only its memory is given back. free_twists: v* of free bodies, the
  // prescribed twist of the others. laws: one per contact. stops: ends of joints' ranges. Gravity (m/s^2) is what acts
  // on the liquid that sticks to bodies. Where the report does not say that it converged, the fields of the state are
  // not those of any solution.
  [[nodiscard]] CoupledReport solve(FaceField<double>& free_velocity, const std::vector<Vector6d>& free_twists,
                                    const std::vector<Contact>& contacts, const std::vector<ContactLaw>& laws,
                                    const std::vector<JointStop>& stops, const Eigen::Vector3d& gravity,
                                    const CoupledOptions& options, CoupledState& state);

  const StepProblem& problem() const;
  // Kinetic energy (J) and momentum (kg m/s) of the liquid that sticks to the bodies, when these have `twists`.
  double stickingEnergy(const std::vector<Vector6d>& twists) const;
  Eigen::Vector3d stickingMomentum(const std::vector<Vector6d>& twists) const;
  int coupledBodies() const;  // bodies that liquid touches

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace monolith
