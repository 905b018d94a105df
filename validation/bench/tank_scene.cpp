#include "tank_scene.h"

#include <algorithm>
#include <cmath>

#include "scene/solid_body.h"

namespace monolith::bench {
namespace {

constexpr double kDensity = 1000.0;      // kg/m^3, of the liquid
constexpr double kBodyDensity = 2000.0;  // kg/m^3
constexpr double kTimeStep = 0.01;       // s
constexpr double kFriction = 0.3;
// Off the grid's symmetry, m.
const Eigen::Vector3d kOffset(0.0131, -0.0073, 0.0057);

// Boxes (four contact points) and spheres (one) in columns of two, `gap` above the floor and each other; returns the
// height that they take up.
double addResting(int contacts, double gap, std::vector<BodyDescription>& bodies) {
  if (contacts == 0) return 0.0;
  const int boxes = contacts / 4;
  const int count = boxes + contacts % 4;
  const int columns = (count + 1) / 2;
  const int along = static_cast<int>(std::ceil(std::sqrt(columns)));
  const double width = std::min(0.25, 0.6 / along);
  for (int i = 0; i < count; ++i) {
    const int column = i % columns, level = i / columns;
    const Eigen::Vector3d position((column % along + 0.5) / along, (column / along + 0.5) / along,
                                   (level + 0.5) * width + (level + 1) * gap);
    const Eigen::Vector3d aside(kOffset[0], kOffset[1], 0.0);
    const std::string name = "resting_" + std::to_string(i);
    bodies.push_back(i < boxes ? boxBody(name, Eigen::Vector3d::Constant(width), kBodyDensity, position + aside)
                               : sphereBody(name, 0.5 * width, kBodyDensity, position + aside));
  }
  return (count > columns ? 2.0 : 1.0) * (width + gap);
}

void addFree(int count, double low, double high, std::vector<BodyDescription>& bodies) {
  if (count == 0) return;
  const int along = static_cast<int>(std::ceil(std::cbrt(count) - 1e-9));
  const double spacing_z = (high - low) / along;
  const double width = std::min(0.25, 0.7 * std::min(1.0 / along, spacing_z));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d position((i % along + 0.5) / along, (i / along % along + 0.5) / along,
                                   low + (i / (along * along) + 0.5) * spacing_z);
    bodies.push_back(
        sphereBody("free_" + std::to_string(i), 0.5 * width, kBodyDensity, position + 0.1 * width / 0.25 * kOffset));
  }
}

}  // namespace

Scene tankScene(const Case& wanted, double tolerance) {
  Scene scene;
  scene.name = "bench";
  scene.source = "bench";
  scene.tank.cell_width = 1.0 / wanted.size;
  scene.time_step = kTimeStep;
  const double h = scene.tank.cell_width;
  scene.liquid.density = kDensity;
  scene.liquid.dynamic_viscosity = wanted.viscous_number * kDensity * h * h / kTimeStep;
  scene.liquid.fill_level = wanted.fill >= 1.0 ? scene.tank.size[2] : wanted.fill;
  const double height = addResting(wanted.contacts, wanted.apart ? h : 0.0, scene.bodies);
  addFree(wanted.bodies, height, std::max(wanted.fill, height + 0.3), scene.bodies);
  scene.contact.friction = kFriction;
  scene.solver.name = wanted.solver;
  scene.solver.threads = wanted.threads;
  scene.solver.tolerance = tolerance;
  scene.solver.maximum_iterations = 20000;
  scene.solver.cfl = 1e3;  // one sub-step
  return scene;
}

}  // namespace monolith::bench
