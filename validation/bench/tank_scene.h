#pragma once
// The scene that is timed: a cubic tank of 1 m, bodies at rest in it.

#include "scene/scene.h"

namespace monolith::bench {

struct Case {
  int size = 32;
  int threads = 1;
  double viscous_number = 1.0;
  int bodies = 1;
  int contacts = 0;
  double fill = 1.0;
  SolverName solver = SolverName::kFast;
  bool apart = false;  // the bodies of the contacts a cell from what they would rest on
};

// Of the scene; the viscosity is that which the viscous number asks for.
Scene tankScene(const Case& wanted, double tolerance);

}  // namespace monolith::bench
