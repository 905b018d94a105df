#pragma once
// Where a body that hangs on a joint is at the start, and how fast.

#include "scene/scene.h"

namespace monolith {

// Sets pose and velocities of `body` from those of its parent and its joint's initial position q and velocity v, of a
// prescribed joint its rate at time 0, which becomes joint->velocity. With a = the axis in W, p = from the parent's
// origin to the body's:
//   angular velocity = parent's + a v (revolute), parent's (prismatic)
//   velocity = parent's + parent's angular velocity x p (+ a v, prismatic)
void placeOnParent(const BodyDescription& parent, BodyDescription& body);

}  // namespace monolith
