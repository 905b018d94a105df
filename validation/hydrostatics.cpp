#include <cmath>
#include <cstdio>

#include "cases.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

Scene stillTank(int cells, double h, double viscosity) {
  Scene scene;
  scene.name = "still";
  scene.tank.size = Eigen::Vector3d::Constant(cells * h);
  scene.tank.cell_width = h;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.time_step = 0.05;
  return scene;
}

const char* nameOf(Discretisation d) { return d == Discretisation::kFitted ? "fitted" : "fractions"; }

bool stillTankStaysStill(Discretisation discretisation) {
  double worst = 0.0;
  for (const double viscosity : {0.0, 1.0}) {
    for (const double level : {4.5, 4.5004, 4.502, 5.0, 5.37, 5.9999, 16.0}) {  // cells; 16: full, closed
      Scene scene = stillTank(16, 0.01, viscosity);
      scene.liquid.fill_level = level * 0.01;
      scene.solver.discretisation = discretisation;
      Simulation simulation(scene);
      double fastest = 0.0;
      while (simulation.time() < 10.0) {
        const StepReport r = simulation.step();
        if (!r.committed()) return false;
        fastest = std::max(fastest, r.maximum_speed);
      }
      std::printf("still tank, %s, viscosity %g, %.4f cells deep: largest |u| in 10 s %.2e m/s\n", nameOf(discretisation),
                  viscosity, level, fastest);
      worst = std::max(worst, fastest);
    }
  }
  const bool met = worst < 1e-8;
  std::printf("still tank, %s: largest |u| %.2e m/s, goal 1e-8  %s\n", nameOf(discretisation), worst,
              met ? "met" : "MISSED");
  return met;
}

bool sphereBuoyancy(Discretisation discretisation) {
  const double h = 0.01, radius = 4.0 * h;
  bool met = true;
  const Eigen::Vector3d offsets[] = {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {0.25, 0.1, 0.4}, {0.37, 0.21, 0.08}};
  for (const double viscosity : {0.0, 1.0}) {
    for (const Eigen::Vector3d& offset : offsets) {
      Scene scene = stillTank(16, h, viscosity);
      scene.liquid.fill_level = 0.16;
      scene.bodies.push_back(sphereBody("sphere", radius, 500.0, Eigen::Vector3d::Constant(0.08) + h * offset));
      scene.bodies[0].motion = BodyMotion::kFixed;
      scene.solver.discretisation = discretisation;
      Simulation simulation(scene);
      if (!simulation.step().committed()) return false;
      const double expected = 1000.0 * 9.81 * volume(scene.bodies[0].shapes[0]);
      char name[64];
      std::snprintf(name, sizeof(name), "sphere D/h 8, %s, viscosity %g", nameOf(discretisation), viscosity);
      met = report(name, "buoyancy N", simulation.bodyStates()[0].liquid.force[2], expected, 0.01) && met;
    }
  }
  return met;
}

bool boxDraught() {
  const double h = 0.01;
  bool met = true;
  for (const double density : {300.0, 500.0, 800.0}) {
    Scene scene = stillTank(24, h, 1.0);
    scene.time_step = 0.02;
    scene.liquid.fill_level = 0.12;
    const Eigen::Vector3d size(0.1, 0.1, 0.06);
    const Eigen::Vector3d start(0.1237, 0.1181, 0.155);
    scene.bodies.push_back(boxBody("box", size, density, start));
    Simulation simulation(scene);
    while (simulation.time() < 12.0) {
      const StepReport r = simulation.step();
      if (!r.committed()) {
        std::printf("floating box: %s\n", r.message.c_str());
        return false;
      }
    }
    const double expected = density / 1000.0 * size[2];
    const double area = 0.24 * 0.24;
    const double level = (0.12 * area + expected * size[0] * size[1]) / area;
    const double bottom = simulation.bodyStates()[0].X_WB.translation()[2] - 0.5 * size[2];
    const double miss = std::abs((level - bottom) - expected) / h;
    met = met && miss < 0.25;
    std::printf("floating box, density %g: draught %.5f m, Archimedes %.5f m, off by %.3f h, goal 0.25 h  %s\n", density,
                level - bottom, expected, miss, miss < 0.25 ? "met" : "MISSED");
  }
  return met;
}

}  // namespace

bool runHydrostatics() {
  bool still = true, buoyancy = true;
  for (const Discretisation discretisation : {Discretisation::kFitted, Discretisation::kFractions}) {
    still = stillTankStaysStill(discretisation) && still;
    buoyancy = sphereBuoyancy(discretisation) && buoyancy;
  }
  const bool draught = boxDraught();
  return still && buoyancy && draught;
}

}  // namespace monolith
