#pragma once
// Parts of scenes that cases share.

#include <string>

#include "framework/case.h"
#include "scene/solid_body.h"

namespace monolith {

// Path of a scene in config/scenes.
std::string shippedScene(const std::string& name);

// Tolerance, solver and discretisation as the numerics have them; one thread, so that CPU time is work; the time step
// unless the numerics leave it to the scene. The cell width is the case's to derive from cells_across.
void apply(const Numerics& numerics, Scene& scene);

}  // namespace monolith
