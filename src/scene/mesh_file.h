#pragma once
// Collision meshes from STL, OBJ and DAE files.
//
// Vertices in m, in the frame of the file: node transforms and the <unit> of a DAE are applied, its <up_axis> is
// not, as everywhere in ROS. Welded, closed, oriented outwards (turned over if the file has it inside out).

#include <Eigen/Core>
#include <string>

#include "geometry/shape.h"

namespace monolith {

// Throws SceneError naming the file and what is wrong with it: unreadable, no triangles, a number of open or
// misoriented edges, a cavity, no volume.
TriangleMesh loadMeshFile(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace monolith
