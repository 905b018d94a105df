#pragma once
// Homogeneous bodies of one shape, for scenes that are made by a program rather than read from files.

#include <string>

#include "scene/scene.h"

namespace monolith {

// Radius and position of the centre in m, density in kg/m^3.
BodyDescription sphereBody(const std::string& name, double radius, double density, const Eigen::Vector3d& position);
// Edges along the body's axes and position of the centre in m, density in kg/m^3.
BodyDescription boxBody(const std::string& name, const Eigen::Vector3d& size, double density,
                        const Eigen::Vector3d& position);
// Along the body's z axis; as above.
BodyDescription cylinderBody(const std::string& name, double radius, double length, double density,
                             const Eigen::Vector3d& position);

}  // namespace monolith
