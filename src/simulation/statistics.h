#pragma once
// What a step tells about itself. Every step returns one; `~statistics` publishes it.

#include <Eigen/Dense>
#include <string>

#include "coupling/solve_status.h"

namespace monolith {

struct StageTimes {  // s of wall time, summed over the sub-steps
  double advection = 0.0;
  double contact = 0.0;
  double geometry = 0.0;  // fractions, coefficients, multigrid levels
  double solve = 0.0;
  double surface = 0.0;
  double total = 0.0;
};

struct ModelChoice {  // what the last sub-step modelled, chosen from the state; before the first what the state tells
  bool liquid = false;
  bool viscosity = false;
  bool non_newtonian = false;
  bool free_surface = false;
  int time_order = 1;      // of its time stepping; 1 also where 2 was asked for: Simulation::Impl::weights()
  int coupled_bodies = 0;  // bodies with at least one coupling row
  int joints = 0;          // with a motion of their own
  int contacts = 0;
  bool friction = false;  // at least one of the contacts has a friction coefficient
};

struct StepReport {
  SolveStatus status = SolveStatus::kNotRun;
  std::string message;  // empty if all went well
  std::string warning;  // of a step that went well what whoever runs it should know, once; or empty
  long step = 0;        // output steps since the start
  double time = 0.0;    // s, simulated, after the step
  int substeps = 0;
  int retries = 0;                 // sub-steps that failed and were taken again, half as long; their work counts, too
  int iterations = 0;              // Krylov, summed over the sub-steps
  int liquid_solves = 0;           // coupled linear solves, summed over the sub-steps
  int friction_iterations = 0;     // of Coulomb's law on the small system, summed over the sub-steps
  int rheology_iterations = 0;     // of the viscosity, summed over the sub-steps; Newtonian: none
  double residual = 0.0;           // relative, worst of the sub-steps
  double contact_residual = 0.0;   // of Coulomb's law, relative, worst of the sub-steps
  double divergence = 0.0;         // 1/s, largest in a liquid cell
  double maximum_speed = 0.0;      // m/s, no liquid is faster: norm of the largest components
  double liquid_volume = 0.0;      // m^3
  double volume_correction = 0.0;  // m^3, signed, that the surface was corrected by in this step
  double kinetic_energy = 0.0;     // J, liquid and free bodies
  Eigen::Vector3d liquid_momentum = Eigen::Vector3d::Zero();  // kg m/s, in W
  double potential_energy = 0.0;                              // J, liquid and free bodies, zero at the world's origin
  double penetration = 0.0;                                   // m, deepest
  ModelChoice model;
  StageTimes times;

  bool committed() const { return status == SolveStatus::kConverged; }
};

}  // namespace monolith
