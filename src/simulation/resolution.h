#pragma once
// What of a scene its grid is too coarse for.

#include <limits>
#include <string>

#include "rigid/rigid_body.h"

namespace monolith {

struct BodyResolution {
  double thinnest = std::numeric_limits<double>::infinity();  // RigidBody::thinnest
  std::string warning;                                        // what whoever runs the scene should know, or empty
};

// On a grid of cells `cell_width` (m) wide.
BodyResolution judgeResolution(double cell_width, const RigidBody& body);

}  // namespace monolith
