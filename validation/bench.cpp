#include <omp.h>

#include <cstdio>
#include <ctime>

#include "cases.h"
#include "scene/scene_file.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

bool runBench() {
  // The demo over its first second: falling, splash and coming to rest.
  std::printf("drop scene, first second, means per sub-step (ms of wall time; CPU in s per output step)\n");
  std::printf("%5s %7s %8s %6s %9s %8s %9s %7s %8s %8s %9s %9s\n", "cells", "threads", "substeps", "iter", "advection",
              "contact", "geometry", "solve", "surface", "total", "CPU/step", "real-time");
  for (const int cells : {24, 32, 48}) {
    for (const int threads : {1, 2}) {
      if (threads > omp_get_num_procs()) continue;
      Scene scene = loadScene(shippedScene("drop"), {});
      scene.tank.cell_width = scene.tank.size[0] / cells;
      scene.solver.threads = threads;
      Simulation simulation(scene);
      StageTimes sum;
      long substeps = 0, iterations = 0;
      const double cpu = cpuSeconds();
      while (simulation.time() < 1.0 - 1e-9) {
        const StepReport r = simulation.step();
        if (!r.committed()) {
          std::printf("drop at %d^3, %.2f s: %s\n", cells, r.time, r.message.c_str());
          return false;
        }
        substeps += r.substeps;
        iterations += r.iterations;
        sum.advection += r.times.advection;
        sum.contact += r.times.contact;
        sum.geometry += r.times.geometry;
        sum.solve += r.times.solve;
        sum.surface += r.times.surface;
        sum.total += r.times.total;
      }
      const double steps = simulation.time() / scene.time_step;
      const double ms = 1e3 / static_cast<double>(substeps);
      std::printf("%4d^3 %7d %8ld %6.1f %9.1f %8.1f %9.1f %7.1f %8.1f %8.1f %9.3f %9.3f\n", cells, threads, substeps,
                  static_cast<double>(iterations) / static_cast<double>(substeps), ms * sum.advection, ms * sum.contact,
                  ms * sum.geometry, ms * sum.solve, ms * sum.surface, ms * sum.total, (cpuSeconds() - cpu) / steps,
                  simulation.time() / sum.total);
      std::fflush(stdout);
    }
  }
  return true;
}

}  // namespace monolith
