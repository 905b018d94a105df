#pragma once
// Creeping flow about bodies: dimensionless scenes (density and viscosity 1, lengths about 1) whose steps are so long
// that a few lead to the steady state.

#include "framework/case.h"
#include "framework/meter.h"

namespace monolith {

// Goals of drag and torque, by cells across the body.
double dragGoal(double cells_across);

// No gravity, no bodies, full and closed along the axes that are not periodic.
Scene creepingScene(const Eigen::Vector3d& size, double cell_width, const Numerics& numerics);

// Makes a body's surface move as told, while the body stays where it is: the force at this moment of its motion.
void moveInPlace(BodyDescription& body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity);

// Steps until `value` of the simulation changes by less than 1e-6 (relative); returns it.
double steadyValue(Simulation& simulation, Meter& meter, const std::function<double(const StepReport&)>& value);

}  // namespace monolith
