#pragma once
// Physics cases against analytic results and published experiments. Each runs the production library on a scene, prints a
// line per variant with the figure, the reference and the error, and returns whether every goal was met.

#include <string>
#include <vector>

#include "scene/scene.h"

namespace monolith {

// Drag of a periodic array of spheres (Zick & Homsy 1982, J. Fluid Mech. 115, 13): 1 % at D/h = 10, 5 % at D/h = 4.
bool runSphereArray();
// A still tank, the buoyancy of a sphere, the draught of a floating box.
bool runHydrostatics();
// ten Cate et al. 2002 (Phys. Fluids 14, 4012), case E1: peak speed within 5 % at D/h = 6.
bool runSettling();
// Liquid volume and penetration over 60 s of the drop scene.
bool runVolume(double seconds);
// A box on a slope, dry and under liquid: friction angle within 0.1 degree, no drift below it.
bool runSlope();
// A set of scenes by every solver, coupling and discretisation: error, iterations, time, memory.
bool runSolvers();
// What each part of the model costs.
bool runBlocks();
// Plane channels of non-Newtonian liquids against analytic profiles: 2 % at 32 cells across.
bool runChannel();

// Parts that cases share.
std::string shippedScene(const std::string& name);
BodyDescription sphereBody(const std::string& name, double radius, double density, const Eigen::Vector3d& position);
BodyDescription boxBody(const std::string& name, const Eigen::Vector3d& size, double density,
                        const Eigen::Vector3d& position);
// Prints one result; returns whether |error| <= goal (a relative error, as a fraction).
bool report(const std::string& variant, const std::string& quantity, double result, double reference, double goal);

}  // namespace monolith
