// What `fast` adds to the step's definition: its columns of the bodies against the plain rows, iterations that depend
// neither on the mesh nor on the viscosity, and the same bits on any number of threads.

#include "coupling/fast_solver.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <random>

#include "coupling/body_columns.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

// A unit box, closed and full or with a sloping surface, with a free sphere and a free box.
struct SphereStep {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;
  StepVector rhs;

  static MacGrid makeGrid(const std::array<int, 3>& n, const std::array<bool, 3>& periodic) {
    MacGrid g;
    g.lattice = Lattice(n, periodic);
    g.h = 1.0 / n[0];
    return g;
  }
  SphereStep(const std::array<int, 3>& n, double number, double fill, const std::array<bool, 3>& periodic = {})
      : grid(makeGrid(n, periodic)), problem(grid) {
    const double dt = 0.01;
    bodies.push_back(makeRigidBody(sphereBody("free", 0.16, 1500.0, {0.53, 0.57, 0.46}), 0.5 * grid.h));
    bodies.push_back(makeRigidBody(boxBody("moved", {0.2, 0.22, 0.17}, 800.0, {0.2, 0.23, 0.31}), 0.5 * grid.h));
    bodies[0].twist << 0.1, -0.2, -0.3, 0.5, 0.2, -0.4;
    SolidSampler(grid).sample(bodies, solids);
    const Lattice& l = grid.lattice;
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + (fill < 1.0 ? 0.05 * i : 0.0) - fill * n[0];
      }
    }
    extendIntoHalo(l, liquid);
    problem.assemble(solids, bodies, liquid, 1000.0, number * 1000.0 * grid.h * grid.h / dt, dt);
    const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
    FaceField<double> velocity;
    for (int a = 0; a < 3; ++a) {
      velocity[a].assign(l.size, 0.0);
      for (int k = 0; k < l.faceEnd(2); ++k) {
        for (int j = 0; j < l.faceEnd(1); ++j) {
          for (int i = 0; i < l.faceEnd(0); ++i) {
            const Eigen::Vector3d x = grid.faceCenter(a, i, j, k);
            const Eigen::Vector3d swirl(std::sin(3.0 * x[1]), std::sin(4.0 * x[2] + x[0]), -std::cos(3.0 * x[0]));
            velocity[a][l.index(i, j, k)] = 0.3 * swirl[a] + dt * gravity[a];
          }
        }
      }
    }
    std::vector<Vector6d> twists;
    for (const RigidBody& body : bodies) twists.push_back(freeTwist(body, gravity, Wrench(), dt));
    EXPECT_EQ(problem.rightSide(velocity, twists, gravity, rhs), "");
  }
  CoupledReport solve(double tolerance, StepVector& x) {
    x = StepVector();
    x.resize(grid.lattice, bodies.size());
    FastSolver fast;
    fast.prepare(problem);
    CoupledOptions options;
    options.tolerance = tolerance;
    const CoupledReport report = fast.solve(rhs, options, x);
    EXPECT_EQ(report.status, SolveStatus::kConverged) << report.message;
    return report;
  }
};

TEST(FastSolver, ColumnsOfTheBodiesAreThePlainRows) {
  for (const double number : {0.0, 0.01, 3.0}) {
    for (const bool periodic : {false, true}) {
      SCOPED_TRACE(number);
      SphereStep step({12, 13, 12}, number, 0.6, {periodic, false, false});
      const StepProblem& p = step.problem;
      const Lattice& l = step.grid.lattice;
      const auto n = p.bodyUnknowns();
      ASSERT_EQ(n, 12);
      const Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(n, 0.5, 2.0);
      BodyColumns<double> columns;
      columns.set(p, scale);
      StepOperator op;
      op.set(&p.coefficients, &p.rows);
      std::mt19937 random(1);
      std::normal_distribution<double> gauss;
      StepVector x, y;
      x.resize(l, 2);
      const Eigen::VectorXd v = Eigen::VectorXd::NullaryExpr(n, [&] { return gauss(random); });
      p.coordinates.scatterMotion(v.cwiseQuotient(scale), x.bodies);
      op.apply(x, y);
      for (auto& field : y.velocity) clearHalo(l, field);
      clearHalo(l, y.pressure);
      std::vector<double> packed(4 * l.size, 0.0);
      const LiquidFields<double> fields = packedFields(l, packed.data());
      columns.addMotion(v.data(), fields);
      double largest = 0.0;
      for (std::size_t i = 0; i < l.size; ++i) {
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(packed[a * l.size + i], y.velocity[a][i], 1e-10);
        EXPECT_NEAR(packed[3 * l.size + i], y.pressure[i], 1e-10);
        largest = std::max(largest, std::abs(y.pressure[i]));
      }
      EXPECT_GT(largest, 0.1);
      // Taken away, and given back to the bit.
      LiquidPlaces<double> before;
      std::vector<double> other = packed;
      for (double& value : other) value += gauss(random);
      const std::vector<double> was = other;
      columns.takeMotion(v.data(), packedFields(l, other.data()), before);
      for (std::size_t i = 0; i < other.size(); ++i) EXPECT_NEAR(other[i], was[i] - packed[i], 1e-10);
      EXPECT_NE(other, was);
      columns.giveBack(before, packedFields(l, other.data()));
      EXPECT_EQ(other, was);
      const Eigen::VectorXd own = p.coordinates.gatherForces(y.bodies).cwiseQuotient(scale);
      EXPECT_LT((columns.ownResistance() * v - own).norm(), 1e-11 * (1.0 + own.norm()));

      // Transposed.
      for (auto& twist : x.bodies) twist.setZero();
      for (std::size_t i = 0; i < l.size; ++i) {
        for (int a = 0; a < 3; ++a) x.velocity[a][i] = p.coefficients.mass[a][i] > 0.0 ? gauss(random) : 0.0;
        x.pressure[i] = p.coefficients.has_pressure[i] ? gauss(random) : 0.0;
      }
      for (auto& field : x.velocity) clearHalo(l, field);
      clearHalo(l, x.pressure);
      for (int a = 0; a < 3; ++a) std::copy(x.velocity[a].begin(), x.velocity[a].end(), packed.begin() + a * l.size);
      std::copy(x.pressure.begin(), x.pressure.end(), packed.begin() + 3 * l.size);
      op.apply(x, y);
      const Eigen::VectorXd forces = p.coordinates.gatherForces(y.bodies).cwiseQuotient(scale);
      EXPECT_LT((columns.forces(packedFields<const double>(l, packed.data())) - forces).norm(),
                1e-11 * (1.0 + forces.norm()));
    }
  }
}

// To the tolerance that leaves accelerations right to 1e-4; closer, large viscous numbers meet single precision's floor
// and begin a second cycle.
TEST(FastSolver, IterationsDependNeitherOnTheMeshNorOnViscosity) {
  for (const double fill : {1.5, 0.6}) {
    for (const double number : {0.0, 1.0, 100.0, 1e4}) {
      StepVector x;
      const int coarse = SphereStep({16, 16, 16}, number, fill).solve(1e-4, x).iterations;
      const int fine = SphereStep({32, 32, 32}, number, fill).solve(1e-4, x).iterations;
      EXPECT_LE(fine, 1.5 * coarse) << "viscous number " << number << ", fill " << fill;
      EXPECT_LE(fine, 30) << "viscous number " << number << ", fill " << fill;
    }
  }
}

TEST(FastSolver, SameBitsOnAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  StepVector x, y;
  omp_set_num_threads(1);
  SphereStep({32, 20, 24}, 2.0, 0.6).solve(1e-5, x);
  omp_set_num_threads(3);
  SphereStep({32, 20, 24}, 2.0, 0.6).solve(1e-5, y);
  omp_set_num_threads(before);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(x.velocity[a], y.velocity[a]);
  EXPECT_EQ(x.pressure, y.pressure);
  for (std::size_t b = 0; b < x.bodies.size(); ++b) EXPECT_EQ(x.bodies[b], y.bodies[b]);
}

}  // namespace
}  // namespace monolith
