// What holds exactly for every step, over scenes drawn from seeds: density ratios 1e-3 to 1e4, viscous
// numbers 0 to 1e4, bodies that touch, overlap the surface and each other's cells, walls or none.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "random_step.h"

namespace monolith {
namespace {

constexpr int kScenes = 200;

// Random velocities, pressures and twists where they are unknowns.
StepVector draw(const RandomStep& step, std::mt19937& random) {
  std::normal_distribution<double> normal;
  StepVector x = step.start();
  const auto& c = step.problem.coefficients;
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < x.velocity[a].size(); ++i) x.velocity[a][i] = c.mass[a][i] > 0.0 ? normal(random) : 0.0;
    clearHalo(step.grid.lattice, x.velocity[a]);
  }
  for (std::size_t i = 0; i < x.pressure.size(); ++i) x.pressure[i] = c.has_pressure[i] ? normal(random) : 0.0;
  clearHalo(step.grid.lattice, x.pressure);
  for (auto& twist : x.bodies) {
    for (double& v : twist) v = normal(random);
  }
  return x;
}

// (a, b) over velocities, pressures and twists.
std::array<double, 3> products(const StepVector& a, const StepVector& b) {
  std::array<double, 3> sum{};
  for (int d = 0; d < 3; ++d) {
    for (std::size_t i = 0; i < a.velocity[d].size(); ++i) sum[0] += a.velocity[d][i] * b.velocity[d][i];
  }
  for (std::size_t i = 0; i < a.pressure.size(); ++i) sum[1] += a.pressure[i] * b.pressure[i];
  for (std::size_t i = 0; i < a.bodies.size(); ++i) sum[2] += a.bodies[i].dot(b.bodies[i]);
  return sum;
}

double product(const StepVector& a, const StepVector& b) {
  const auto sum = products(a, b);
  return sum[0] + sum[1] + sum[2];
}

// What is left of x if only velocities (0), pressures (1) or twists (2) stay.
StepVector only(StepVector x, int block) {
  for (auto& field : x.velocity) {
    if (block != 0) std::fill(field.begin(), field.end(), 0.0);
  }
  if (block != 1) std::fill(x.pressure.begin(), x.pressure.end(), 0.0);
  for (auto& twist : x.bodies) {
    if (block != 2) twist.setZero();
  }
  return x;
}

double divergence(const RandomStep& step, StepVector x) {
  std::vector<Wrench> liquid;
  std::vector<double> work;
  double out = 0.0;
  step.problem.results(x, Eigen::Vector3d::Zero(), liquid, out, work);
  return out;
}

// The largest divergence is below what the solve's tolerance, relative to the whole right side, lets pass.
void expectNoDivergence(const RandomStep& step, const StepVector& x, const Eigen::VectorXd& r, double tolerance) {
  StepVector b = step.rhs;
  if (r.size() > 0) {
    StepVector contact = step.start();
    step.problem.coordinates.scatterForces(step.rows.J.transpose() * r, contact.bodies);
    for (std::size_t i = 0; i < b.bodies.size(); ++i) b.bodies[i] += contact.bodies[i];
  }
  const double allowed = tolerance * stepNorm(step.problem, b) / step.grid.h;
  EXPECT_LE(divergence(step, x), allowed);
  StepVector before = step.start();
  before.velocity = step.free_velocity;
  step.problem.toUnknowns(before.velocity);
  before.bodies = step.free_twists;
  EXPECT_GT(divergence(step, before), 1e4 * allowed);
}

class StepProperties : public testing::TestWithParam<Discretisation> {};

TEST_P(StepProperties, OperatorIsSymmetricAndItsVelocityBlockPositive) {
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, GetParam());
    std::mt19937 random(seed + 1000);
    StepVector x = draw(step, random), y = draw(step, random), Ax, Ay;
    const StepVector x0 = x, y0 = y;
    step.problem.apply(x, Ax);
    step.problem.apply(y, Ay);
    const double size = std::sqrt(product(Ax, Ax) * product(y0, y0)) + std::sqrt(product(Ay, Ay) * product(x0, x0));
    EXPECT_LT(std::abs(product(y0, Ax) - product(x0, Ay)), 1e-13 * size);
    StepVector u = x0, Au;
    std::fill(u.pressure.begin(), u.pressure.end(), 0.0);
    step.problem.apply(u, Au);
    EXPECT_GE(product(u, Au), step.energy(u.velocity, u.bodies) * (1.0 - 1e-12));
  }
}

// Divergence and gradient, J_p and its transpose, J_s and its transpose: each is applied by code of its own.
TEST_P(StepProperties, EachPairIsAdjoint) {
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, GetParam());
    std::mt19937 random(seed + 2000);
    const StepVector x0 = draw(step, random), y0 = draw(step, random);
    for (const auto& [row, column] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 2)}) {
      StepVector x = only(x0, column), y = only(y0, row), Ax, Ay;
      step.problem.apply(x, Ax);
      step.problem.apply(y, Ay);
      const StepVector from_row = only(Ax, row), from_column = only(Ay, column);
      const double size = std::sqrt(product(from_row, from_row) * product(y, y));
      EXPECT_NEAR(products(y, from_row)[row], products(x, from_column)[column], 1e-13 * size) << row << column;
      if (row != 0 || column != 2 || step.number > 0.0) {
        EXPECT_GT(size, 0.0) << row << column;
      }
    }
  }
}

// Liquid and bodies that move on together feel their inertia and nothing else; without walls, and full.
TEST_P(StepProperties, MotionOfAllAsOneCostsNothingButInertia) {
  const Eigen::Vector3d velocity(0.6, -1.0, 0.3);
  for (unsigned seed = 3; seed < kScenes; seed += 4) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, GetParam());
    ASSERT_FALSE(step.walls);
    const Lattice& l = step.grid.lattice;
    StepVector x = step.start(), Ax;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < x.velocity[a].size(); ++i) {
        x.velocity[a][i] = step.problem.coefficients.mass[a][i] > 0.0 ? velocity[a] : 0.0;
      }
    }
    step.problem.toUnknowns(x.velocity);
    for (auto& twist : x.bodies) twist.head<3>() = velocity;
    step.problem.apply(x, Ax);
    double size = 1.0 + step.number;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> expected = step.problem.coefficients.mass[a];
      for (std::size_t i = 0; i < expected.size(); ++i) expected[i] *= x.velocity[a][i];
      clearHalo(l, expected);
      double worst = 0.0;
      for (std::size_t i = 0; i < expected.size(); ++i) {
        worst = std::max(worst, std::abs(Ax.velocity[a][i] - expected[i]));
      }
      EXPECT_LT(worst, 1e-11 * size);
    }
    EXPECT_LT(std::abs(*std::max_element(Ax.pressure.begin(), Ax.pressure.end())), 1e-11);
    EXPECT_LT(std::abs(*std::min_element(Ax.pressure.begin(), Ax.pressure.end())), 1e-11);
    for (std::size_t i = 0; i < step.problem.free.size(); ++i) {
      const int body = step.problem.free[i];
      const Vector6d inertial = step.problem.inertia[i] * x.bodies[body];
      EXPECT_LT((Ax.bodies[body] - inertial).norm(), 1e-10 * (size + inertial.norm()));
    }
  }
}

TEST_P(StepProperties, EnergyNeverGrowsAndContactsObeyTheirLaw) {
  int with_contacts = 0, slipping = 0;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, GetParam());
    // With fractions and viscous numbers over 1000 `fast` may need more iterations than it has.
    std::unique_ptr<StepSolver> solver = std::make_unique<FastSolver>();
    if (GetParam() == Discretisation::kFractions) solver = std::make_unique<DirectSolver>();
    solver->prepare(step.problem);
    CoupledOptions options;
    options.tolerance = 1e-8;
    StepVector x = step.start();
    Eigen::VectorXd r;
    const CoupledReport report = solver->solveWithContacts(step.rhs, step.rows, options, x, r);
    ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message << ", number " << step.number;
    FaceField<double> unknowns = step.free_velocity;
    step.problem.toUnknowns(unknowns);
    const double before = step.energy(unknowns, step.free_twists);
    EXPECT_LE(step.energy(x.velocity, x.bodies), before * (1.0 + 1e-6));
    const Eigen::Index m = step.rows.count();
    expectNoDivergence(step, x, r, options.tolerance);
    if (m == 0) continue;
    ++with_contacts;
    const Eigen::VectorXd w = step.rows.J * step.problem.coordinates.gatherMotion(x.bodies) + step.rows.bias;
    // What a contact gives way by, at most: by the response of the bodies without liquid.
    Eigen::MatrixXd response = Eigen::MatrixXd::Zero(step.problem.bodyUnknowns(), step.problem.bodyUnknowns());
    for (std::size_t i = 0; i < step.problem.free.size(); ++i) {
      response.block<6, 6>(6 * i, 6 * i) = step.problem.inertia[i].inverse();
    }
    Eigen::VectorXd compliance;
    contactResponse(step.rows, response, compliance);
    // Speeds are of the order of 1 m/s before the step.
    const double fastest = w.cwiseAbs().maxCoeff() + 0.1, largest = std::max(r.cwiseAbs().maxCoeff(), 1e-300);
    for (Eigen::Index c = 0; c < m; ++c) {
      EXPECT_GE(w[c] + compliance[c] * r[c], -1e-6 * fastest);
      EXPECT_GE(r[c], 0.0);
      EXPECT_LT(std::min(r[c] / largest, w[c] / fastest), 1e-5);
      const Eigen::Vector2d f = r.segment<2>(m + 2 * c), slip = w.segment<2>(m + 2 * c);
      EXPECT_LE(f.norm(), step.rows.friction[c] * r[c] * (1.0 + 1e-6));
      if (slip.norm() < 1e-3 * fastest || r[c] < 1e-3 * largest) continue;
      ++slipping;
      EXPECT_LT((f / (step.rows.friction[c] * r[c]) + slip.normalized()).norm(), 1e-2);
    }
  }
  EXPECT_GT(with_contacts, 40);
  EXPECT_GT(slipping, 20);
}

// A body at rest in still liquid: rho g times the sum of its fractions of faces, which is its volume.
TEST_P(StepProperties, BuoyancyIsTheWeightOfTheDiscreteVolume) {
  constexpr double kDensity = 1000.0, kGravity = 9.81, kStep = 0.01;
  MacGrid grid;
  grid.lattice = Lattice({8, 9, 10}, {false, false, false});
  grid.h = 0.1;
  const Lattice& l = grid.lattice;
  for (const double fill : {100.0, 8.3}) {
    for (const double viscosity : {0.0, 10.0, 1e4}) {
      SCOPED_TRACE(testing::Message() << "fill " << fill << ", viscosity " << viscosity);
      BodyDescription body = sphereBody("ball", 0.17, 700.0, {0.413, 0.437, 0.388});
      body.motion = BodyMotion::kFixed;
      const std::vector<RigidBody> bodies = {makeRigidBody(body, 0.05)};
      SolidFractions solids;
      SolidSampler(grid).sample(bodies, solids);
      double faces = 0.0;
      for (const double fraction : solids.bodies[0].face[2]) faces += fraction;
      const double discrete = faces * std::pow(grid.h, 3);
      EXPECT_NEAR(discrete / volume(body.shapes[0]), 1.0, 1e-4);
      std::vector<double> liquid(l.size, 0.0);
      for (int k = 0; k < l.n[2]; ++k) {
        for (int j = 0; j < l.n[1]; ++j) {
          for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 - fill;
        }
      }
      extendIntoHalo(l, liquid);
      StepProblem problem(grid, GetParam());
      problem.sticking_viscosity = 1.0;
      problem.assemble(solids, bodies, liquid, kDensity, viscosity, kStep);
      FaceField<double> free_velocity;
      for (int a = 0; a < 3; ++a) free_velocity[a].assign(l.size, a == 2 ? -kGravity * kStep : 0.0);
      const Eigen::Vector3d gravity(0.0, 0.0, -kGravity);
      StepVector rhs, x;
      ASSERT_EQ(problem.rightSide(free_velocity, {Vector6d::Zero()}, gravity, rhs), "");
      x.resize(l, 1);
      CoupledOptions options;
      options.tolerance = 1e-11;
      DirectSolver direct;
      direct.prepare(problem);
      const CoupledReport report = direct.solve(rhs, options, x);
      ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message;
      std::vector<Wrench> wrenches;
      std::vector<double> work;
      double largest_divergence = 0.0;
      problem.results(x, gravity, wrenches, largest_divergence, work);
      const double expected = kDensity * kGravity * discrete;
      EXPECT_NEAR(wrenches[0].force[2], expected, 1e-9 * expected);
      EXPECT_LT(wrenches[0].force.head<2>().norm(), 1e-9 * expected);
      for (const auto& component : x.velocity) {
        for (const double u : component) ASSERT_LT(std::abs(u), 1e-9);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Discretisations, StepProperties,
                         testing::Values(Discretisation::kFitted, Discretisation::kFractions), [](const auto& info) {
                           return info.param == Discretisation::kFitted ? "Fitted" : "Fractions";
                         });

TEST(StepMomentum, OfLiquidAndBodiesBalances) {
  int tested = 0;
  for (unsigned seed = 3; seed < kScenes; seed += 4) {  // without walls, and full: nothing else to push against
    SCOPED_TRACE(seed);
    RandomStep step(seed);
    ASSERT_FALSE(step.walls);
    DirectSolver direct;
    direct.prepare(step.problem);
    CoupledOptions options;
    options.tolerance = 1e-9;
    StepVector x = step.start();
    Eigen::VectorXd r;
    const CoupledReport report = direct.solveWithContacts(step.rhs, step.rows, options, x, r);
    ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message;
    // The liquid that sticks to a body had the body's velocity before: so does its inertia.
    const Eigen::Vector3d before = step.momentum(step.free_velocity, step.free_twists);
    const Eigen::Vector3d change = step.momentum(x.velocity, x.bodies) - before;
    double size = 1.0;
    for (std::size_t b = 0; b < step.bodies.size(); ++b) size = std::max(size, step.problem.inertia[b](0, 0));
    EXPECT_LT(change.norm(), 1e-8 * size);
    ++tested;
  }
  EXPECT_EQ(tested, kScenes / 4);
}

// What liquid and free bodies lose, a body that is held fast receives.
TEST(StepMomentum, GoesToWhatIsHeldFast) {
  for (unsigned seed = 3; seed < kScenes; seed += 4) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, Discretisation::kFitted, BodyMotion::kFixed);
    DirectSolver direct;
    direct.prepare(step.problem);
    CoupledOptions options;
    options.tolerance = 1e-9;
    StepVector x = step.start();
    const CoupledReport report = direct.solve(step.rhs, options, x);
    ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message;
    const Eigen::Vector3d change =
        step.momentum(x.velocity, x.bodies) - step.momentum(step.free_velocity, step.free_twists);
    std::vector<Wrench> liquid;
    std::vector<double> work;
    double divergence = 0.0;
    step.problem.results(x, Eigen::Vector3d::Zero(), liquid, divergence, work);
    const Eigen::Vector3d received = liquid[0].force * (step.problem.dt / step.problem.impulse_scale);
    EXPECT_GT(received.norm(), 1e-3);
    double size = 1.0;
    for (const Matrix6d& inertia : step.problem.inertia) size = std::max(size, inertia(0, 0));
    EXPECT_LT((change + received).norm(), 1e-8 * size);
  }
}

}  // namespace
}  // namespace monolith
