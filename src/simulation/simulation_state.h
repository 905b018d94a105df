#pragma once
// Everything that a step may change, and that an uncommitted step must leave.

#include <vector>

#include "coupling/coupled_system.h"
#include "fluid/free_surface.h"
#include "rigid/rigid_body.h"
#include "simulation/joint_drives.h"

namespace monolith {

// Steps of backward Euler after a state that was set: one in which the velocity jumps, and one for the next to
// continue.
constexpr int kStepsAfterSet = 2;

struct SimulationState {
  double time = 0.0;
  long step = 0;
  std::vector<RigidBody> bodies;
  std::vector<FreeSurface> surface;  // exactly one; a vector because it has no default
  CoupledState coupled;
  FaceMask known;
  FaceField<double> acceleration;                 // m/s^2, of the liquid's particles, mean over the last sub-step
  std::vector<Vector6d> body_acceleration;        // likewise
  std::vector<char> departed;                     // bodies whose departure from the tank has been told
  std::vector<Vector6d> stuck_twists;             // of the liquid that sticks to each body, set or not since
  std::vector<Wrench> mean_liquid, mean_contact;  // over the last output step
  std::vector<double> mean_effort;                // likewise, N m, N, of the bodies' joints
  std::vector<Wrench> joints;  // on each body by what joints do implicitly, mean over the last sub-step
  std::vector<JointMode> joint_modes;
  double liquid_speed = 0.0;                      // m/s, no component of the velocity is larger
  double fastest = 0.0;                           // m/s, see typicalSpeed()
  double last_dt = 0.0;                           // s, of the last sub-step
  int euler_steps = kStepsAfterSet;               // sub-steps of backward Euler that are due
  std::size_t substeps = 0;
  bool started = false;
  double typical_viscosity = 0.0;  // Pa s; of a non-Newtonian liquid that of the last solve
  double liquid_energy = 0.0;      // J, kinetic, after the last output step
};

}  // namespace monolith
