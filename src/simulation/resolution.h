#pragma once
// What of a scene its grid is too coarse for.

#include <string>

#include "rigid/rigid_body.h"

namespace monolith {

// Fills in body.thinnest for a grid of cells `cell_width` (m) wide. Returns what whoever runs the scene should know of
// the body, or nothing.
std::string judgeResolution(double cell_width, RigidBody& body);

}  // namespace monolith
