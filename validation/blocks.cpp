#include <cstdio>

#include "cases.h"
#include "framework/meter.h"
#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr int kSteps = 10;

Scene start(double fill, double viscosity) {
  Scene scene;
  scene.name = "blocks";
  scene.tank.size = {0.32, 0.32, 0.32};
  scene.tank.cell_width = 0.01;
  scene.liquid.density = 1000.0;
  scene.liquid.fill_level = fill;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = 0.01;
  scene.solver.threads = 1;
  return scene;
}

// Three balls that sink in a row, loose or held together by two hinges, each with a servo, damping and friction.
std::vector<BodyDescription> row(bool jointed) {
  const Eigen::Vector3d first(0.07, 0.16, 0.1), next(0.08, 0.0, 0.0);
  std::vector<BodyDescription> bodies = {sphereBody("head", 0.032, 2500.0, first)};
  for (int i : {1, 2}) {
    const BodyDescription ball = sphereBody("ball" + std::to_string(i), 0.032, 2500.0, first + i * next);
    if (!jointed) {
      bodies.push_back(ball);
      continue;
    }
    JointDescription hinge;
    hinge.name = "hinge" + std::to_string(i);
    hinge.axis = Eigen::Vector3d::UnitY();
    hinge.X_PJ.translation() = next;
    hinge.position = 0.2;
    hinge.damping = hinge.friction = 1e-3;
    hinge.servo = {1.0, 0.1};
    hangOn(bodies, i - 1, ball, hinge);
  }
  return bodies;
}

bool measure(const char* text, const Scene& scene) {
  Simulation simulation(scene);
  if (!simulation.step().committed()) return false;  // the first one sets up
  StageTimes sum;
  long iterations = 0, substeps = 0;
  StepReport r;
  const double cpu = cpuSeconds();
  for (int i = 0; i < kSteps; ++i) {
    r = simulation.step();
    if (!r.committed()) {
      std::printf("%s: %s\n", text, r.message.c_str());
      return false;
    }
    sum.advection += r.times.advection;
    sum.geometry += r.times.geometry;
    sum.solve += r.times.solve;
    sum.surface += r.times.surface;
    iterations += r.iterations;
    substeps += r.substeps;
  }
  const double ms = 1e3 / static_cast<double>(substeps);
  std::printf("%-44s %9.1f %9.1f %8.1f %8.1f %9.1f %6.1f   %s%s%s%d bodies, %d joints, %d contacts%s\n", text,
              ms * sum.advection, ms * sum.geometry, ms * sum.solve, ms * sum.surface, ms * (cpuSeconds() - cpu),
              static_cast<double>(iterations) / static_cast<double>(substeps), r.model.liquid ? "liquid " : "",
              r.model.viscosity ? "viscosity " : "", r.model.free_surface ? "surface " : "", r.model.coupled_bodies,
              r.model.joints, r.model.contacts, r.model.friction ? " friction" : "");
  std::fflush(stdout);
  return true;
}

}  // namespace

bool runBlocks() {
  std::printf("32^3 cells, one thread, means per sub-step in ms (CPU: of all stages)\n");
  std::printf("%-44s %9s %9s %8s %8s %9s %6s   %s\n", "scene", "advection", "geometry", "solve", "surface", "CPU",
              "iter", "what was modelled");
  const BodyDescription ball = sphereBody("ball", 0.04, 2500.0, {0.15, 0.16, 0.1});
  const BodyDescription box = boxBody("box", {0.1, 0.08, 0.06}, 2500.0, {0.2, 0.16, 0.03});
  bool good = true;
  Scene scene = start(0.0, 0.0);
  scene.bodies = {ball};
  good = measure("a body, no liquid", scene) && good;
  scene = start(0.32, 0.0);
  scene.bodies = {ball};
  good = measure("full tank, no viscosity, a body", scene) && good;
  scene = start(0.2, 0.0);
  scene.bodies = {ball};
  good = measure("and a free surface", scene) && good;
  scene = start(0.2, 1.0);
  scene.bodies = {ball};
  good = measure("and viscosity", scene) && good;
  scene.gravity = {2.0, 0.0, -9.6};
  scene.bodies = {box};
  good = measure("the body rests on the floor and slides", scene) && good;
  scene.contact.friction = 0.5;
  good = measure("and has friction", scene) && good;
  scene = start(0.2, 1.0);
  scene.bodies = row(false);
  good = measure("three bodies", scene) && good;
  scene.bodies = row(true);
  good = measure("held together by two joints with servos", scene) && good;
  return good;
}

}  // namespace monolith
