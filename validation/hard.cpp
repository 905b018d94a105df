#include <algorithm>
#include <cstdio>
#include <random>

#include "cases.h"
#include "framework/meter.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr int kSteps = 150;
constexpr int kBodies = 8;

Scene tank(double fill, double viscosity) {
  Scene scene;
  scene.name = "hard";
  scene.tank.size = {0.2, 0.2, 0.4};
  scene.tank.cell_width = 0.02;
  scene.liquid.fill_level = fill;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = 0.02;
  scene.solver.threads = 1;
  return scene;
}

// Boxes, balls and cylinders above each other, turned at random, densities up to `ratio` times as large as others'.
Scene pile(double fill, double viscosity, double friction, double ratio) {
  Scene scene = tank(fill, viscosity);
  scene.contact.friction = friction;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int b = 0; b < kBodies; ++b) {
    const double density = 2000.0 * (b % 2 == 1 ? 1.0 / ratio : 1.0);
    const Eigen::Vector3d place(0.05 + 0.1 * (b % 2), 0.05 + 0.1 * (b / 2 % 2), 0.06 + 0.11 * (b / 4));
    const std::string name = "body" + std::to_string(b);
    BodyDescription body = b % 3 == 0   ? boxBody(name, {0.07, 0.05, 0.04}, density, place)
                           : b % 3 == 1 ? cylinderBody(name, 0.025, 0.06, density, place)
                                        : sphereBody(name, 0.03, density, place);
    // Towards each other, so that they pile up.
    body.velocity = Eigen::Vector3d(0.1 - place[0], 0.1 - place[1], 0.0) * (b < kBodies / 2 ? 2.0 : 8.0);
    const Eigen::Vector3d axis(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    body.X_WB.linear() = Eigen::AngleAxisd(2.0 * M_PI * unit(random), axis.normalized()).toRotationMatrix();
    scene.bodies.push_back(body);
  }
  return scene;
}

// Cubes of liquid around a box each, which fall on the floor.
Scene blobs(int count, double viscosity) {
  Scene scene = tank(0.0, viscosity);
  scene.tank.size = {0.24 * count, 0.24, 0.32};
  for (int b = 0; b < count; ++b) {
    const Eigen::Vector3d centre(0.12 + 0.24 * b, 0.12, 0.18), half(0.09, 0.09, 0.09);
    scene.liquid.boxes.emplace_back(centre - half, centre + half);
    scene.bodies.push_back(boxBody("box" + std::to_string(b), {0.08, 0.08, 0.08}, 1500.0, centre));
  }
  return scene;
}

bool measure(const char* text, const Scene& scene) {
  Simulation simulation(scene);
  long iterations = 0, law = 0;
  int failed = 0, retries = 0, contacts = 0;
  double cpu = 0.0, worst = 0.0, moving = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double before = cpuSeconds();
    const StepReport r = simulation.step();
    const double took = cpuSeconds() - before;
    if (!r.committed()) ++failed;
    cpu += took;
    worst = std::max(worst, took);
    iterations += r.iterations;
    law += r.friction_iterations;
    retries += r.retries;
    contacts = std::max(contacts, r.model.contacts);
    moving = r.kinetic_energy;
  }
  std::printf("%-52s %8d %7d %8d %9.1f %9.0f %7.1f %7.1f %10.1e\n", text, contacts, failed, retries, 1e3 * cpu / kSteps,
              1e3 * worst, static_cast<double>(iterations) / kSteps, static_cast<double>(law) / kSteps, moving);
  std::fflush(stdout);
  return failed == 0;
}

}  // namespace

bool runHard() {
  std::printf(
      "%d steps of 0.02 s each, one thread; piles of %d bodies that fall and come to rest, and thick liquid that\n"
      "nothing holds. CPU in ms a step, mean and worst; iterations a step, of the solve and of Coulomb's law.\n",
      kSteps, kBodies);
  std::printf("%-52s %8s %7s %8s %9s %9s %7s %7s %10s\n", "scene", "contacts", "failed", "retries", "CPU", "worst",
              "solve", "law", "J at end");
  bool good = true;
  good = measure("dry pile, friction 0.3", pile(0.0, 1.0, 0.3, 1.0)) && good;
  good = measure("dry pile, friction 0.8, densities 1 to 1000", pile(0.0, 1.0, 0.8, 1000.0)) && good;
  good = measure("pile in water, friction 0.3", pile(0.2, 1e-3, 0.3, 1.0)) && good;
  good = measure("pile in 1 Pa.s, friction 0.8, densities 1 to 1000", pile(0.2, 1.0, 0.8, 1000.0)) && good;
  good = measure("pile in 1e4 Pa.s, friction 0.3, densities 1 to 1000", pile(0.2, 1e4, 0.3, 1000.0)) && good;
  good = measure("a falling blob of 1e3 Pa.s around a box", blobs(1, 1e3)) && good;
  good = measure("a falling blob of 1e5 Pa.s around a box", blobs(1, 1e5)) && good;
  good = measure("two of 1e4 Pa.s", blobs(2, 1e4)) && good;
  return good;
}

}  // namespace monolith
