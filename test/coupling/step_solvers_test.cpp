// `fast`, `direct` and `reference`, and the couplings `unified` and `iterative`, hold the same step: the same
// velocities, pressures, twists and contact forces.

#include <gtest/gtest.h>

#include <algorithm>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "coupling/iterative_coupling.h"
#include "coupling/reference_solver.h"
#include "rigid/contact.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

// A stack of two boxes that slides and tips on the floor of a tank of liquid, a third one free.
struct StackStep {
  MacGrid grid;
  TankWalls walls;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;
  StepVector rhs;
  ContactRows rows;
  std::vector<Contact> contacts;

  StackStep(double viscosity, double fill, double friction, double density_scale,
            Discretisation discretisation = Discretisation::kFitted)
      : problem(makeGrid(), discretisation) {
    grid = makeGrid();
    walls.inside = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.8, 0.8, 1.0));
    const double h = grid.h;
    bodies.push_back(makeRigidBody(boxBody("low", {0.42, 0.37, 0.25}, 2000.0 * density_scale, {0.37, 0.41, 0.125}), h));
    bodies.push_back(makeRigidBody(boxBody("high", {0.25, 0.3, 0.21}, 3000.0 * density_scale, {0.42, 0.37, 0.355}), h));
    bodies.push_back(makeRigidBody(boxBody("loose", {0.2, 0.22, 0.21}, 700.0 * density_scale, {0.45, 0.5, 0.8}), h));
    bodies[0].twist << 0.3, 0.1, 0.0, 0.0, 0.0, 0.2;
    bodies[1].twist << -0.2, 0.4, -0.1, 0.0, 0.1, 0.5;
    SolidSampler(grid).sample(bodies, solids);
    const Lattice& l = grid.lattice;
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 - fill / h;
      }
    }
    extendIntoHalo(l, liquid);
    const double dt = 0.02;
    const Eigen::Vector3d gravity(0.5, 0.0, -9.81);
    problem.assemble(solids, bodies, liquid, 1000.0, viscosity, dt);
    FaceField<double> free_velocity;
    for (int a = 0; a < 3; ++a) free_velocity[a].assign(l.size, dt * gravity[a]);
    std::vector<Vector6d> free_twists;
    for (const RigidBody& body : bodies) free_twists.push_back(freeTwist(body, gravity, Wrench(), dt));
    EXPECT_EQ(problem.rightSide(free_velocity, free_twists, gravity, rhs), "");
    ContactDetector detector(bodies, walls);
    contacts = detector.detect(bodies, 0.01);
    rows = buildContactRows(problem, contacts, std::vector<ContactLaw>(contacts.size(), {friction, 0.0}), {}, 0.1);
  }
  static MacGrid makeGrid() {
    MacGrid g;
    g.lattice = Lattice({8, 8, 10}, {false, false, false});
    g.h = 0.1;
    return g;
  }
  StepVector start() const {
    StepVector x;
    x.resize(grid.lattice, bodies.size());
    return x;
  }
};

struct Answer {
  CoupledReport report;
  StepVector x;
  Eigen::VectorXd r;
};

Answer answer(StackStep& step, StepSolver& solver, CouplingName coupling, double tolerance) {
  Answer out;
  out.x = step.start();
  CoupledOptions options;
  options.tolerance = tolerance;
  options.maximum_iterations = 400;
  solver.prepare(step.problem);
  out.report = coupling == CouplingName::kUnified
                   ? solver.solveWithContacts(step.rhs, step.rows, options, out.x, out.r)
                   : solveIteratively(solver, step.problem, step.rhs, step.rows, options, out.x, out.r);
  EXPECT_EQ(out.report.status, SolveStatus::kConverged) << out.report.message;
  return out;
}

double velocityDifference(const StepVector& a, const StepVector& b) {
  double sum = 0.0, size = 0.0;
  for (int d = 0; d < 3; ++d) {
    for (std::size_t i = 0; i < a.velocity[d].size(); ++i) {
      sum += std::pow(a.velocity[d][i] - b.velocity[d][i], 2);
      size += std::pow(b.velocity[d][i], 2);
    }
  }
  return std::sqrt(sum / size);
}

void expectSame(const StackStep& step, const Answer& a, const Answer& b, double tolerance, const std::string& what) {
  if (step.problem.coefficients.has_pressure.end() !=
      std::find(step.problem.coefficients.has_pressure.begin(), step.problem.coefficients.has_pressure.end(), 1)) {
    EXPECT_LT(velocityDifference(a.x, b.x), tolerance) << what;
  }
  double fastest = 0.0;
  for (const Vector6d& twist : b.x.bodies) fastest = std::max(fastest, twist.norm());
  for (std::size_t i = 0; i < step.bodies.size(); ++i) {
    EXPECT_LT((a.x.bodies[i] - b.x.bodies[i]).norm(), tolerance * fastest) << what << ", body " << i;
  }
  // Forces of redundant contacts are not unique, what they do to the bodies is.
  const Eigen::VectorXd fa = step.rows.J.transpose() * a.r, fb = step.rows.J.transpose() * b.r;
  EXPECT_LT((fa - fb).norm(), tolerance * fb.norm()) << what;
}

struct Parameters {
  double viscosity, fill, friction, density_scale;
  Discretisation discretisation = Discretisation::kFitted;
};

class StepSolvers : public testing::TestWithParam<Parameters> {};

TEST_P(StepSolvers, Agree) {
  const Parameters p = GetParam();
  StackStep step(p.viscosity, p.fill, p.friction, p.density_scale, p.discretisation);
  ASSERT_GE(step.contacts.size(), 8u);
  DirectSolver direct;
  FastSolver fast;
  ReferenceSolver reference;
  const Answer exact = answer(step, direct, CouplingName::kUnified, 1e-10);
  expectSame(step, answer(step, fast, CouplingName::kUnified, 1e-9), exact, 2e-6, "fast");
  expectSame(step, answer(step, reference, CouplingName::kUnified, 1e-9), exact, 2e-6, "reference");
  expectSame(step, answer(step, direct, CouplingName::kIterative, 1e-9), exact, 2e-5, "iterative");
}

TEST_P(StepSolvers, ContactsObeyTheirLaw) {
  const Parameters p = GetParam();
  StackStep step(p.viscosity, p.fill, p.friction, p.density_scale, p.discretisation);
  DirectSolver direct;
  const Answer a = answer(step, direct, CouplingName::kUnified, 1e-10);
  const Eigen::Index m = step.rows.count();
  const Eigen::VectorXd w = step.rows.J * step.problem.coordinates.gatherMotion(a.x.bodies) + step.rows.bias;
  const double largest = a.r.cwiseAbs().maxCoeff(), fastest = w.cwiseAbs().maxCoeff();
  int slipping = 0, pressing = 0;
  for (Eigen::Index c = 0; c < m; ++c) {
    EXPECT_GE(a.r[c], 0.0);
    EXPECT_GE(w[c], -1e-7 * fastest);
    EXPECT_LT(a.r[c] * w[c], 1e-6 * largest * fastest);
    pressing += a.r[c] > 1e-6 * largest;
    const Eigen::Vector2d f = a.r.segment<2>(m + 2 * c), slip = w.tail(2 * m).segment<2>(2 * c);
    EXPECT_LE(f.norm(), p.friction * a.r[c] * (1.0 + 1e-9));
    if (p.friction == 0.0 || a.r[c] < 1e-6 * largest || slip.norm() < 1e-6 * fastest) continue;
    ++slipping;
    EXPECT_LT((f / (p.friction * a.r[c]) + slip.normalized()).norm(), 1e-5) << "contact " << c;
  }
  EXPECT_GE(pressing, 3);
  if (p.friction > 0.0 && p.friction < 0.3) {
    EXPECT_GE(slipping, 3);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, StepSolvers,
                         testing::Values(Parameters{0.0, 0.0, 0.3, 1.0}, Parameters{0.0, 0.55, 0.0, 1.0},
                                         Parameters{0.0, 0.55, 0.2, 1.0}, Parameters{20.0, 0.55, 0.0, 1.0},
                                         Parameters{20.0, 0.55, 0.2, 1.0}, Parameters{20.0, 0.55, 1.0, 1.0},
                                         Parameters{20.0, 1.5, 0.2, 1.0},
                                         // Light and heavy for the liquid; and by the paper's discretisation.
                                         Parameters{0.0, 0.55, 0.2, 0.03}, Parameters{20.0, 1.5, 0.2, 0.1},
                                         Parameters{20.0, 0.55, 0.2, 100.0},
                                         Parameters{0.0, 0.55, 0.2, 1.0, Discretisation::kFractions},
                                         Parameters{20.0, 0.55, 0.2, 1.0, Discretisation::kFractions}));

}  // namespace
}  // namespace monolith
