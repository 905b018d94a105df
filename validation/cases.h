#pragma once
// Comparisons of the library's parts with each other; physics is in validation/physics. Each prints its figures and
// returns whether every goal was met.

#include "framework/scene_parts.h"

namespace monolith {

// A set of scenes by every solver, coupling and discretisation: error, iterations, time, memory.
bool runSolvers();
// What each part of the model costs.
bool runBlocks();
// Speed and error of the demo against its step, tolerance and cell width.
bool runPace();
// Whether and how fast piles of bodies and thick liquid that nothing holds are solved.
bool runHard();

}  // namespace monolith
