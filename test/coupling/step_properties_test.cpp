// What holds exactly for every step (DESIGN 1.3), over scenes drawn from seeds: density ratios 1e-3 to 1e4, viscous
// numbers 0 to 1e4, bodies that touch, overlap the surface and each other's cells, walls or none.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "rigid/contact.h"

namespace monolith {
namespace {

constexpr int kScenes = 200;

struct RandomStep {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;
  FaceField<double> free_velocity;
  std::vector<Vector6d> free_twists;
  StepVector rhs;
  std::vector<Contact> contacts;
  ContactRows rows;
  bool walls = true;
  double number = 0.0;

  static MacGrid makeGrid(unsigned seed) {
    MacGrid g;
    const bool open = seed % 4 == 3;  // periodic along all axes: no walls
    g.lattice = Lattice({8, 7, 9}, {open, open || seed % 8 == 1, open});
    g.h = 0.1;
    return g;
  }

  explicit RandomStep(unsigned seed) : problem(makeGrid(seed)) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto signedUnit = [&] { return 2.0 * unit(random) - 1.0; };
    grid = makeGrid(seed);
    const Lattice& l = grid.lattice;
    walls = !l.periodic[0];
    const Eigen::Vector3d size = grid.size();
    for (int b = 0; b < 3; ++b) {
      BodyDescription body;
      body.name = "body" + std::to_string(b);
      Shape shape;
      shape.kind = static_cast<Shape::Kind>(b);
      shape.box_size = 0.15 * Eigen::Vector3d(1.0 + unit(random), 1.0 + unit(random), 1.0 + unit(random));
      shape.radius = 0.1 + 0.05 * unit(random);
      shape.length = 0.25;
      shape.name = body.name;
      body.shapes = {shape};
      body.mass = 1000.0 * std::pow(10.0, -3.0 + 7.0 * unit(random)) * volume(shape);
      body.inertia_Bcm = body.mass * 0.008 * Eigen::Vector3d(1.0, 1.2, 0.9).asDiagonal();
      body.X_WB.translation() = Eigen::Vector3d((0.3 + 0.4 * unit(random)) * size[0],
                                                (0.3 + 0.4 * unit(random)) * size[1], (0.2 + 0.25 * b) * size[2]);
      body.X_WB.linear() =
          Eigen::Quaterniond(signedUnit(), signedUnit(), signedUnit(), signedUnit()).normalized().toRotationMatrix();
      bodies.push_back(makeRigidBody(body, 0.05));
      for (int d = 0; d < 6; ++d) bodies.back().twist[d] = (d < 3 ? 1.0 : 5.0) * signedUnit();
    }
    SolidSampler(grid).sample(bodies, solids);
    const double fill = seed % 2 ? 100.0 : 4.0 + 4.0 * unit(random);
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + 0.1 * i - fill;
      }
    }
    extendIntoHalo(l, liquid);
    const double dt = 0.01;
    number = seed % 5 == 0 ? 0.0 : std::pow(10.0, -2.0 + 6.0 * unit(random));
    problem.assemble(solids, bodies, liquid, 1000.0, number * 1000.0 * grid.h * grid.h / dt, dt);
    for (int a = 0; a < 3; ++a) {
      free_velocity[a].assign(l.size, 0.0);
      for (double& u : free_velocity[a]) u = signedUnit();
    }
    for (const RigidBody& body : bodies) free_twists.push_back(body.twist);
    EXPECT_EQ(problem.rightSide(free_velocity, free_twists, Eigen::Vector3d::Zero(), rhs), "");
    TankWalls tank;
    tank.inside = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), size);
    for (int a = 0; a < 3; ++a) tank.periodic[a] = l.periodic[a];
    contacts = ContactDetector(bodies, tank).detect(bodies, 0.02);
    for (Contact& c : contacts) c.gap = std::max(c.gap, 0.0);
    rows = buildContactRows(problem, contacts, std::vector<ContactLaw>(contacts.size(), {unit(random), 0.0}),
                            free_twists, 1.0);
  }

  // Twice the kinetic energy of liquid and bodies over rho h^3.
  double energy(const FaceField<double>& u, const std::vector<Vector6d>& twists) const {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> mass = problem.coefficients.mass[a];
      clearHalo(grid.lattice, mass);
      for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * u[a][i] * u[a][i];
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) sum += twists[b].dot(problem.inertia[b] * twists[b]);
    return sum;
  }
  Eigen::Vector3d momentum(const FaceField<double>& u, const std::vector<Vector6d>& twists) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) {
      std::vector<double> mass = problem.coefficients.mass[a];
      clearHalo(grid.lattice, mass);
      for (std::size_t i = 0; i < mass.size(); ++i) sum[a] += mass[i] * u[a][i];
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) sum += (problem.inertia[b] * twists[b]).head<3>();
    return sum;
  }
  StepVector start() const {
    StepVector x;
    x.resize(grid.lattice, bodies.size());
    return x;
  }
};

TEST(StepProperties, OperatorIsSymmetricAndItsVelocityBlockPositive) {
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed);
    std::mt19937 random(seed + 1000);
    std::normal_distribution<double> normal;
    const auto draw = [&] {
      StepVector x = step.start();
      const auto& c = step.problem.coefficients;
      for (int a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < x.velocity[a].size(); ++i)
          x.velocity[a][i] = c.mass[a][i] > 0.0 ? normal(random) : 0.0;
        clearHalo(step.grid.lattice, x.velocity[a]);
      }
      for (std::size_t i = 0; i < x.pressure.size(); ++i) x.pressure[i] = c.has_pressure[i] ? normal(random) : 0.0;
      clearHalo(step.grid.lattice, x.pressure);
      for (auto& twist : x.bodies) {
        for (double& v : twist) v = normal(random);
      }
      return x;
    };
    const auto dot = [](const StepVector& a, const StepVector& b) {
      double sum = 0.0;
      for (int d = 0; d < 3; ++d) {
        for (std::size_t i = 0; i < a.velocity[d].size(); ++i) sum += a.velocity[d][i] * b.velocity[d][i];
      }
      for (std::size_t i = 0; i < a.pressure.size(); ++i) sum += a.pressure[i] * b.pressure[i];
      for (std::size_t i = 0; i < a.bodies.size(); ++i) sum += a.bodies[i].dot(b.bodies[i]);
      return sum;
    };
    StepVector x = draw(), y = draw(), Ax, Ay;
    const StepVector x0 = x, y0 = y;
    step.problem.apply(x, Ax);
    step.problem.apply(y, Ay);
    const double size = std::sqrt(dot(Ax, Ax) * dot(y0, y0)) + std::sqrt(dot(Ay, Ay) * dot(x0, x0));
    EXPECT_LT(std::abs(dot(y0, Ax) - dot(x0, Ay)), 1e-13 * size);
    StepVector u = x0, Au;
    std::fill(u.pressure.begin(), u.pressure.end(), 0.0);
    step.problem.apply(u, Au);
    EXPECT_GE(dot(u, Au), step.energy(u.velocity, u.bodies) * (1.0 - 1e-12));
  }
}

TEST(StepProperties, EnergyNeverGrowsAndContactsObeyTheirLaw) {
  int with_contacts = 0, slipping = 0;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed);
    FastSolver fast;
    fast.prepare(step.problem);
    CoupledOptions options;
    options.tolerance = 1e-8;
    StepVector x = step.start();
    Eigen::VectorXd r;
    const CoupledReport report = fast.solveWithContacts(step.rhs, step.rows, options, x, r);
    ASSERT_EQ(report.status, CoupledReport::Status::kConverged) << report.message << ", number " << step.number;
    const double before = step.energy(step.free_velocity, step.free_twists);
    EXPECT_LE(step.energy(x.velocity, x.bodies), before * (1.0 + 1e-6));
    const Eigen::Index m = step.rows.count();
    if (m == 0) continue;
    ++with_contacts;
    const Eigen::VectorXd w = step.rows.J * gatherBodies(step.problem, x.bodies) + step.rows.bias;
    // Speeds are of the order of 1 m/s before the step.
    const double fastest = w.cwiseAbs().maxCoeff() + 0.1, largest = std::max(r.cwiseAbs().maxCoeff(), 1e-300);
    for (Eigen::Index c = 0; c < m; ++c) {
      EXPECT_GE(w[c], -1e-5 * fastest);
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

TEST(StepProperties, MomentumOfLiquidAndBodiesBalances) {
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
    ASSERT_EQ(report.status, CoupledReport::Status::kConverged) << report.message;
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

}  // namespace
}  // namespace monolith
