#pragma once
// Homogeneous bodies of one shape, for scenes that are made by a program rather than read from files.

#include <string>
#include <vector>

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

// Appends `body` to those of a scene as hung on bodies[parent] by the joint: named ROOT/NAME after the one that hangs
// on nothing, motion kFree, pose and velocities as scene/joint_placement.h has them. The reference is good until the
// next call.
BodyDescription& hangOn(std::vector<BodyDescription>& bodies, int parent, BodyDescription body, JointDescription joint);

}  // namespace monolith
