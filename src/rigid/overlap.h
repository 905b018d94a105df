#pragma once
// Bodies that start inside one another or inside a wall, found whole: also one deep within another.

#include <string>
#include <vector>

#include "rigid/contact.h"

namespace monolith {

// f(wall, depth): for every wall ("-x" .. "+z"), how far a body with this box (W) reaches out of it, m; negative: it
// does not.
template <class Function>
void forEachWallDepth(const TankWalls& walls, const Eigen::AlignedBox3d& box, Function&& f) {
  for (int axis = 0; axis < 3; ++axis) {
    if (walls.periodic[axis]) continue;
    const std::string name(1, "xyz"[axis]);
    f("-" + name, walls.inside.min()[axis] - box.min()[axis]);
    f("+" + name, box.max()[axis] - walls.inside.max()[axis]);
  }
}

// A line for every pair of bodies that may touch and penetrate by more than `tolerance` (m), in any of their periodic
// images, with their names and the depth, and for every body that sticks out of a wall ("-x" .. "+z"); empty if all is
// well. Depth: of convex shapes the least translation that parts them (rigid/convex_separation.h); with a mesh the
// deepest of many points of each surface within the other. only: the index of a body whose overlaps alone count, with
// those of what joints connect to it; -1: all.
std::string describeOverlaps(const std::vector<RigidBody>& bodies, const TankWalls& walls, double tolerance,
                             int only = -1);

}  // namespace monolith
