#include <cmath>
#include <cstdio>

#include "cases.h"
#include "scene/scene_file.h"
#include "simulation/simulation.h"

namespace monolith {

bool runVolume(double seconds) {
  Scene scene = loadScene(shippedScene("drop"), {});
  Simulation simulation(scene);
  double start = 0.0, drift = 0.0, corrected = 0.0, net = 0.0, depth = 0.0, wall = 0.0;
  while (simulation.time() < seconds - 1e-9) {
    const StepReport r = simulation.step();
    if (!r.committed()) {
      std::printf("drop at %.2f s: %s\n", r.time, r.message.c_str());
      return false;
    }
    if (r.step == 1) start = r.liquid_volume;
    drift = std::max(drift, std::abs(r.liquid_volume / start - 1.0));
    corrected += std::abs(r.volume_correction) / start;
    net += r.volume_correction / start;
    depth = std::max(depth, r.penetration);
    wall += r.times.total;
    if (r.step % 250 == 0) {
      std::printf("  t %5.1f s  volume drift %.1e  corrections: net %+.3f %%, total %.3f %%  penetration %.1e m\n", r.time,
                  drift, 100.0 * net, 100.0 * corrected, depth);
      std::fflush(stdout);
    }
  }
  const double h = scene.tank.cell_width;
  const bool met = drift < 0.01 && depth < 0.05 * h;
  std::printf("drop, %.0f s: volume drift %.4f %% (goal 1 %%), of it taken back by shifting the surface %.3f %%; "
              "deepest penetration %.4f h (goal 0.05 h); %.1f s of wall time  %s\n",
              seconds, 100.0 * drift, 100.0 * net, depth / h, wall, met ? "met" : "MISSED");
  return met;
}

}  // namespace monolith
