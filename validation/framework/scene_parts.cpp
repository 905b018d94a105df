#include "framework/scene_parts.h"

namespace monolith {
std::string shippedScene(const std::string& name) {
  return std::string(MONOLITH_SOURCE_DIR "/config/scenes/") + name + ".yaml";
}

void apply(const Numerics& numerics, Scene& scene) {
  if (numerics.dt > 0.0) scene.time_step = numerics.dt;
  scene.solver.tolerance = numerics.tolerance;
  scene.solver.name = numerics.solver;
  scene.solver.discretisation = numerics.discretisation;
  scene.solver.threads = 1;
}

}  // namespace monolith
