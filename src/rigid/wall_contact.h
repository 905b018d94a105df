#pragma once
// Contacts of one shape with the tank's walls. Gaps are exact: a wall is a plane, and only corners, rims and the
// poles of spheres touch one first.

#include "rigid/contact.h"

namespace monolith {

// Appends the contacts with gap <= margin; body_a = body, body_b = kWall, the normal into the tank, the point on the
// body. `vertices`: of a mesh, in its own frame; not used for the other kinds.
void appendWallContacts(int body, const Shape& shape, const Eigen::Isometry3d& X_WG,
                        const std::vector<Eigen::Vector3d>& vertices, const TankWalls& walls, double margin,
                        std::vector<Contact>& contacts);

}  // namespace monolith
