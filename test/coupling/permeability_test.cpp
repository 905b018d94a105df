// The part of a uniform push that viscosity lets liquid take on, against Brinkman's profile between two plates.

#include "coupling/permeability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coupling/step_problem.h"

namespace monolith {
namespace {

constexpr double kDensity = 1000.0, kTimeStep = 0.01;

// A full tank that is periodic but for the floor and the ceiling.
struct Plates {
  explicit Plates(double number) {
    MacGrid grid;
    grid.lattice = Lattice({16, 16, 32}, {true, true, false});
    grid.h = 0.05;
    problem = std::make_unique<StepProblem>(grid);
    const Lattice& l = problem->grid.lattice;
    SolidSampler(problem->grid).sample(bodies, solids);
    const std::vector<double> liquid(l.size, -100.0);
    problem->assemble(solids, bodies, liquid, kDensity, number * kDensity * grid.h * grid.h / kTimeStep, kTimeStep);
    const FaceBlocks<double> faces = [&] {
      FaceBlocks<double> blocks;
      buildFaceBlocks(problem->coefficients, blocks, &transfer, &free);
      return blocks;
    }();
    faces.convertTo(single);
    const auto& levels = problem->coarse.levels;
    velocity.set(l, single, transfer, levels, levels.size(), problem->coarse.generation(), 3);
    permeability.set(*problem, problem->viscous_number, velocity, free);
  }

  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::unique_ptr<StepProblem> problem;
  FaceRows<float> transfer, free;
  FaceBlocks<float> single;
  VelocityMultigrid velocity;
  Permeability permeability;
};

TEST(Permeability, BetweenPlatesIsBrinkmans) {
  for (const double number : {4.0, 30.0, 300.0}) {
    Plates plates(number);
    const Lattice& l = plates.problem->grid.lattice;
    const double layer = std::sqrt(plates.problem->viscous_number), half = 0.5 * l.n[2];
    ASSERT_NEAR(plates.problem->viscous_number, number, 1e-9 * number);
    // Along the plates, some cells away from them: u - N u'' = 1, which one cycle on cells twice as wide finds roughly.
    for (int k = 6; k < l.n[2] - 6; ++k) {
      const double exact = 1.0 - std::cosh((k + 0.5 - half) / layer) / std::cosh(half / layer);
      for (int i = 0; i <= l.n[0]; ++i) {
        EXPECT_NEAR(plates.permeability.impulse()[0][l.index(i, 3, k)], exact, 0.25 * exact) << number << ", " << k;
        EXPECT_NEAR(plates.permeability.impulse()[1][l.index(5, i, k)], exact, 0.25 * exact) << number << ", " << k;
      }
    }
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < l.size; ++f) {
        EXPECT_LE(plates.permeability.impulse()[a][f], plates.free[a][f]);
        EXPECT_GE(plates.permeability.impulse()[a][f], 0.0f);
      }
    }
    for (int k = 0; k < l.n[2]; ++k) {
      // What flows towards a plate is tied to it at the first face.
      EXPECT_EQ(plates.permeability.sharp()[l.index(7, 9, k)] != 0, k < 2 || k >= l.n[2] - 2) << k;
    }
  }
}

TEST(Permeability, LastsWhileTheCoarseLevelsDo) {
  Plates plates(30.0);
  EXPECT_FALSE(plates.permeability.lasted());
  const FaceRows<float> before = plates.permeability.impulse();
  plates.permeability.set(*plates.problem, 30.0, plates.velocity, plates.free);
  EXPECT_TRUE(plates.permeability.lasted());
  EXPECT_EQ(plates.permeability.impulse(), before);
  plates.problem->coarse.change();
  plates.permeability.set(*plates.problem, 30.0, plates.velocity, plates.free);
  EXPECT_FALSE(plates.permeability.lasted());
  plates.permeability.forget();
  plates.permeability.set(*plates.problem, 30.0, plates.velocity, plates.free);
  EXPECT_FALSE(plates.permeability.lasted());
}

}  // namespace
}  // namespace monolith
