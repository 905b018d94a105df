#pragma once
// Small scenes for the tests of the coupling: a tank with a few turned bodies, drawn from a seed.

#include <random>

#include "coupling/solid_fractions.h"
#include "coupling/step_operator.h"
#include "coupling/sticking_liquid.h"
#include "coupling/stokes_coefficients.h"
#include "rigid/integration.h"

namespace monolith {

struct CouplingScene {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StaggeredCoefficients<double> coefficients;
  BodyRows rows;
  double viscous_number = 0.0;

  // seed decides sizes, poses, fill and periodicity; bodies may touch, overlap and stick out of the liquid. `endless`:
  // full and periodic along all axes, without walls.
  CouplingScene(unsigned seed, double number, bool endless = false) : viscous_number(number) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    grid.lattice = Lattice({10, 9, 12}, {endless || seed % 3 == 1, endless, endless || seed % 5 == 2});
    grid.h = 0.1;
    grid.origin = Eigen::Vector3d(-0.3, 0.2, 0.1);
    for (int b = 0; b < 3; ++b) {
      BodyDescription body;
      body.name = "body" + std::to_string(b);
      Shape shape;
      shape.kind = static_cast<Shape::Kind>(b);
      shape.box_size = 0.2 * Eigen::Vector3d(1.0 + unit(random), 1.0 + unit(random), 1.0 + unit(random));
      shape.radius = 0.12 + 0.08 * unit(random);
      shape.length = 0.3;
      shape.name = body.name;
      body.shapes = {shape};
      body.X_WB.translation() =
          grid.origin + Eigen::Vector3d(0.3 + 0.4 * unit(random), 0.3 + 0.3 * unit(random), 0.3 + 0.6 * unit(random));
      body.X_WB.linear() = Eigen::Quaterniond(unit(random), unit(random) - 0.5, unit(random) - 0.5, unit(random))
                               .normalized()
                               .toRotationMatrix();
      bodies.push_back(makeRigidBody(body, 0.05));
    }
    SolidSampler(grid).sample(bodies, solids);
    const Lattice& l = grid.lattice;
    const double fill = endless || seed % 2 ? 100.0 : 5.0 + 4.0 * unit(random);
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + 0.15 * i - fill;
      }
    }
    extendIntoHalo(l, liquid);
    if (number >= 0.05) attachStickingLiquid(grid, bodies, liquid, solids);
    const StokesGeometry geometry{&solids.fluid, &solids.distance, &liquid, &solids.cell_distance};
    FaceKinds kinds;
    buildCoefficients(l, geometry, number, coefficients, kinds);
    buildBodyRows(grid, solids, bodies, geometry, coefficients, kinds, rows);
  }
};

// Gaussian numbers where there are unknowns, zero elsewhere.
inline StepVector randomVector(const StaggeredCoefficients<double>& c, std::size_t bodies, unsigned seed,
                               bool with_pressure) {
  const Lattice& l = c.lattice;
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  StepVector v;
  v.resize(l, bodies);
  v.setZero();
  for (int k = 0; k < l.faceEnd(2); ++k) {
    for (int j = 0; j < l.faceEnd(1); ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto at = l.index(i, j, k);
        for (int a = 0; a < 3; ++a) v.velocity[a][at] = c.mass[a][at] > 0.0 ? gauss(random) : 0.0;
        v.pressure[at] = with_pressure && c.has_pressure[at] ? gauss(random) : 0.0;
      }
    }
  }
  for (auto& twist : v.bodies) twist = Vector6d::NullaryExpr([&] { return gauss(random); });
  return v;
}

}  // namespace monolith
