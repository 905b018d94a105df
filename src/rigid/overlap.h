#pragma once
// Bodies that start inside one another or inside a wall, found whole: also one deep within another.

#include <string>
#include <vector>

#include "rigid/contact.h"

namespace monolith {

// A line for every pair of bodies that penetrate by more than `tolerance` (m), with their names and the depth, and for
// every body that sticks out of a wall ("-x" .. "+z"); empty if all is well. Depth: of convex shapes the least
// translation that parts them (rigid/convex_separation.h); with a mesh the deepest of many points of each surface
// within the other. only: the index of a body whose overlaps alone count; -1: all.
std::string describeOverlaps(const std::vector<RigidBody>& bodies, const TankWalls& walls, double tolerance,
                             int only = -1);

}  // namespace monolith
