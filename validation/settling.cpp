#include <algorithm>
#include <cstdio>

#include "cases.h"
#include "scene/scene_file.h"
#include "simulation/simulation.h"

namespace monolith {

bool runSettling() {
  // u_max/u_inf = 0.947 with u_inf = 0.038 m/s: their Tables I and II.
  constexpr double kPeak = 0.947 * 0.038;
  Scene scene = loadScene(shippedScene("settling_sphere"), {});
  Simulation simulation(scene);
  double peak = 0.0;
  while (simulation.time() < 4.2) {
    const StepReport r = simulation.step();
    if (!r.committed()) {
      std::printf("settling sphere: %s\n", r.message.c_str());
      return false;
    }
    const double speed = -simulation.bodyStates()[0].velocity[2];
    peak = std::max(peak, speed);
    if (r.step % 20 == 0) std::printf("  t %.2f s  speed %.5f m/s\n", r.time, speed);
  }
  return report("ten Cate E1, D/h 6", "peak speed m/s", peak, kPeak, 0.05);
}

}  // namespace monolith
