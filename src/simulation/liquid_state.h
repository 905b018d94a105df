#pragma once
// The liquid's part of the state, and what is read off it.

#include <vector>

#include "coupling/coupled_system.h"
#include "fluid/free_surface.h"
#include "scene/scene.h"
#include "simulation/simulation.h"

namespace monolith {

// The tank's grid; a tank without liquid needs none, and one cell stands for it.
MacGrid makeGrid(const TankDescription& tank, const LiquidDescription& liquid);

// Velocity of every face of the tank from that of points in W. Throws std::invalid_argument unless finite.
void setVelocity(const MacGrid& grid, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity,
                 FaceField<double>& faces);

// The rigid motion about a point, m/s and rad/s, that is like that of points as far from it as `radius`.
Vector6d rigidMotion(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity,
                     const Eigen::Vector3d& centre, double radius);

// Norm of the largest components of a velocity at faces: no point of the liquid is faster.
double largestSpeed(const FaceField<double>& velocity);

// The faces whose velocity the solve tells.
void markResolved(const StepProblem& problem, FaceMask& mask);

// both = mask and other. Returns whether that is less than mask.
bool intersect(const FaceMask& mask, const FaceMask& other, FaceMask& both);

// Pressure of the liquid at rest: where it is exact the first solve has nothing to do.
std::vector<double> hydrostaticPressure(const MacGrid& grid, const FreeSurface& surface, double density,
                                        const Eigen::Vector3d& gravity);

// liquid_mass: liquid part of each face's control volume.
struct LiquidMotion {
  double energy = 0.0;                                 // J, kinetic
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();  // kg m/s, in W
};
LiquidMotion liquidMotion(const MacGrid& grid, const FaceField<double>& liquid_mass, const FaceField<double>& velocity,
                          double density);

// J, zero at the world's origin.
double liquidPotential(const MacGrid& grid, const FreeSurface& surface, const SolidFractions& solids, double density,
                       const Eigen::Vector3d& gravity);

std::vector<SurfacePoint> sampleSurface(const MacGrid& grid, const FreeSurface& surface,
                                        const std::vector<float>& cell_distance, const FaceField<double>& velocity);

}  // namespace monolith
