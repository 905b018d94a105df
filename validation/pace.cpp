#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "cases.h"
#include "scene/scene_file.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

// Simulated seconds at which bodies are compared: in the air and the splash, sinking, on the floor.
const std::vector<double> kTimes = {0.2, 0.6, 2.0, 4.0};

struct Pace {
  bool good = true;
  double seconds = 0.0;        // of wall time, for all of it
  double solve_seconds = 0.0;  // of it in the coupled solves
  long substeps = 0, iterations = 0;
  std::vector<std::vector<Eigen::Vector3d>> positions;  // by times, of the bodies' frames
};

Pace run(const Scene& scene) {
  Pace out;
  Simulation simulation(scene);
  const auto start = std::chrono::steady_clock::now();
  for (const double time : kTimes) {
    while (simulation.time() < time - 1e-9) {
      const StepReport r = simulation.step();
      if (!r.committed()) {
        std::printf("%s: %s\n", scene.name.c_str(), r.message.c_str());
        out.good = false;
        return out;
      }
      out.solve_seconds += r.times.solve;
      out.substeps += r.substeps;
      out.iterations += r.iterations;
    }
    out.positions.emplace_back();
    for (const BodyState& body : simulation.bodyStates()) out.positions.back().push_back(body.X_WB.translation());
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

bool compare(const char* text, const Scene& scene, const Pace& truth) {
  const Pace pace = run(scene);
  if (!pace.good) return false;
  std::printf("%-40s %9.2f %8ld %8.1f %7.0f %% %6.1f ", text, kTimes.back() / pace.seconds, pace.substeps,
              1e3 * pace.seconds / static_cast<double>(pace.substeps), 100.0 * pace.solve_seconds / pace.seconds,
              static_cast<double>(pace.iterations) / static_cast<double>(pace.substeps));
  for (std::size_t t = 0; t < kTimes.size(); ++t) {
    double largest = 0.0;
    for (std::size_t b = 0; b < truth.positions[t].size(); ++b) {
      largest = std::max(largest, (pace.positions[t][b] - truth.positions[t][b]).norm());
    }
    std::printf(" %7.2f", 1e3 * largest);
  }
  std::printf("\n");
  std::fflush(stdout);
  return true;
}

}  // namespace

bool runPace() {
  const Scene shipped = loadScene(shippedScene("drop"), {});
  const auto with = [&](double step, double tolerance, double cell = 1.0) {
    Scene scene = shipped;
    scene.time_step *= step;
    scene.solver.cfl *= step;  // or sub-steps in the splash would stay as long
    scene.solver.tolerance *= tolerance;
    scene.tank.cell_width *= cell;
    return scene;
  };
  std::printf(
      "The demo (config/scenes/drop.yaml) at other steps, tolerances and cell widths: speed, and how far its bodies\n"
      "are, the farthest, in mm after so many seconds, from where a quarter of the step and a hundredth of the\n"
      "tolerance take them.\n");
  std::printf("%-40s %9s %8s %8s %9s %6s ", "", "real time", "substeps", "ms each", "solve", "iter");
  for (const double time : kTimes) std::printf(" %5.1f s", time);
  std::printf("\n");
  const Pace truth = run(with(0.25, 0.01));
  if (!truth.good) return false;
  bool good = compare("as it is", shipped, truth);
  good = compare("a tenth of the tolerance", with(1.0, 0.1), truth) && good;
  good = compare("ten times the tolerance", with(1.0, 10.0), truth) && good;
  good = compare("half the step", with(0.5, 1.0), truth) && good;
  good = compare("half the step, a tenth of the tolerance", with(0.5, 0.1), truth) && good;
  good = compare("cells 1.6 times as wide", with(1.0, 1.0, 1.6), truth) && good;
  return good;
}

}  // namespace monolith
