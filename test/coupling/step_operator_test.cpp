#include "coupling/step_operator.h"

#include <gtest/gtest.h>

#include "coupling_scene.h"

namespace monolith {
namespace {

double product(const CouplingScene& scene, StepVector x, StepVector y) {
  const Lattice& l = scene.grid.lattice;
  clearHalo(l, x.pressure);
  clearHalo(l, y.pressure);
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    clearHalo(l, x.velocity[a]);
    for (std::size_t c = 0; c < l.size; ++c) sum += x.velocity[a][c] * y.velocity[a][c];
  }
  for (std::size_t c = 0; c < l.size; ++c) sum += x.pressure[c] * y.pressure[c];
  for (std::size_t b = 0; b < x.bodies.size(); ++b) sum += x.bodies[b].dot(y.bodies[b]);
  return sum;
}

class StepOperatorTest : public ::testing::TestWithParam<double> {};

TEST_P(StepOperatorTest, IsSymmetricSoActionIsReaction) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const CouplingScene scene(seed, GetParam());
    StepOperator op;
    op.set(&scene.coefficients, &scene.rows);
    StepVector x = randomVector(scene.coefficients, scene.bodies.size(), 10 + seed, true),
               y = randomVector(scene.coefficients, scene.bodies.size(), 50 + seed, true), Ax, Ay;
    op.apply(x, Ax);
    op.apply(y, Ay);
    const double scale = std::sqrt(std::abs(product(scene, Ax, Ax) * product(scene, y, y)));
    EXPECT_NEAR(product(scene, y, Ax), product(scene, x, Ay), 1e-12 * scale) << "seed " << seed;
  }
}

TEST_P(StepOperatorTest, VelocityBlockDissipates) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const CouplingScene scene(seed, GetParam());
    StepOperator op;
    op.set(&scene.coefficients, &scene.rows);
    StepVector x = randomVector(scene.coefficients, scene.bodies.size(), 10 + seed, false), Ax;
    op.apply(x, Ax);
    EXPECT_GT(product(scene, x, Ax), 0.0) << "seed " << seed;
  }
}

TEST_P(StepOperatorTest, BodyForcesAreTheBodiesPartOfTheWhole) {
  const CouplingScene scene(4, GetParam());
  StepOperator op;
  op.set(&scene.coefficients, &scene.rows);
  StepVector x = randomVector(scene.coefficients, scene.bodies.size(), 1, true), Ax;
  op.apply(x, Ax);
  const auto [least, most] = std::minmax_element(Ax.pressure.begin(), Ax.pressure.end());
  std::vector<double> divergence;
  EXPECT_NEAR(op.largestDivergence(x, divergence), std::max(-*least, *most), 1e-12 * *most);
  std::vector<Vector6d> forces(scene.bodies.size());
  op.bodyForces(x, forces);
  for (std::size_t b = 0; b < forces.size(); ++b) {
    EXPECT_LT((forces[b] - Ax.bodies[b]).norm(), 1e-11 * (1.0 + Ax.bodies[b].norm()));
  }
}

TEST_P(StepOperatorTest, MotionOfAllAsOneRigidBodyCostsNoForce) {
  // Translation everywhere: no strain, no divergence, whatever the bodies' shapes. What is left is the liquid's
  // inertia.
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const CouplingScene scene(seed, GetParam(), true);
    const Lattice& l = scene.grid.lattice;
    StepOperator op;
    op.set(&scene.coefficients, &scene.rows);
    const Eigen::Vector3d velocity(1.0, -0.7, 0.4);
    StepVector x, Ax;
    x.resize(l, scene.bodies.size());
    x.setZero();
    for (int a = 0; a < 3; ++a) {
      for (std::size_t c = 0; c < l.size; ++c) {
        x.velocity[a][c] = scene.coefficients.mass[a][c] > 0.0 ? velocity[a] : 0.0;
      }
    }
    for (auto& twist : x.bodies) twist.head<3>() = velocity;
    op.apply(x, Ax);
    const double round_off = 1e-13 * (1.0 + GetParam());
    int checked = 0;
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) {
          const auto c = l.index(i, j, k);
          for (int a = 0; a < 3; ++a) {
            EXPECT_NEAR(Ax.velocity[a][c], scene.coefficients.mass[a][c] * velocity[a], 100.0 * round_off);
          }
          if (!scene.coefficients.has_pressure[c]) continue;
          EXPECT_NEAR(Ax.pressure[c], 0.0, 1e-12);
          ++checked;
        }
      }
    }
    EXPECT_GT(checked, 500);
    for (const Vector6d& force : Ax.bodies) EXPECT_LT(force.norm(), 1e4 * round_off);
  }
}

// 0: inviscid; 0.01: slip with drag; 1 and 1e4: no slip with sticking liquid.
INSTANTIATE_TEST_SUITE_P(ViscousNumbers, StepOperatorTest, ::testing::Values(0.0, 0.01, 1.0, 1e4));

}  // namespace
}  // namespace monolith
