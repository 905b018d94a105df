// A step whose bodies are connected by joints: that of free bodies under constraints, whichever way it is solved.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "coupling/iterative_coupling.h"
#include "coupling/random_step.h"
#include "coupling/reference_solver.h"
#include "rigid/articulation.h"

namespace monolith {
namespace {

constexpr unsigned kScenes = 12;
constexpr double kTolerance = 1e-9;

BodyMotion firstMotion(unsigned seed) { return seed % 3 == 0 ? BodyMotion::kFixed : BodyMotion::kFree; }

CoupledOptions closely() {
  CoupledOptions options;
  options.tolerance = kTolerance;
  options.maximum_iterations = 1000;
  return options;
}

// What joint b leaves no motion for, over the twists of all bodies: directions across the axis of the difference
// between what body and parent have at the joint.
Eigen::MatrixXd constraint(const RandomStep& step, int b) {
  const RigidBody &body = step.bodies[b], &parent = step.bodies[b - 1];
  const Eigen::Vector3d at = body.pose().translation(), axis = body.q_WB * body.joint->axis;
  // Relative velocity at the joint, and relative rotation.
  Eigen::MatrixXd relative = Eigen::MatrixXd::Zero(6, 18);
  for (int d = 0; d < 3; ++d) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(d);
    relative.block<1, 3>(d, 6 * b) = e.transpose();
    relative.block<1, 3>(d, 6 * b + 3) = (at - body.p_WBcm).cross(e).transpose();
    relative.block<1, 3>(d, 6 * b - 6) = -e.transpose();
    relative.block<1, 3>(d, 6 * b - 3) = -(at - parent.p_WBcm).cross(e).transpose();
    relative.block<1, 3>(3 + d, 6 * b + 3) = e.transpose();
    relative.block<1, 3>(3 + d, 6 * b - 3) = -e.transpose();
  }
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  Eigen::MatrixXd out(5, 18);
  const int fixed = body.joint->type == JointType::kRevolute ? 0 : 3, across = 3 - fixed;
  out << relative.middleRows<3>(fixed), u.transpose() * relative.middleRows<3>(across),
      v.transpose() * relative.middleRows<3>(across);
  return out;
}

TEST(BodyCoordinates, AreTheMotionsThatJointsLeave) {
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    const RandomStep step(seed, Discretisation::kFitted, firstMotion(seed), true);
    const BodyCoordinates& unknowns = step.problem.coordinates;
    const bool held = firstMotion(seed) == BodyMotion::kFixed;
    ASSERT_EQ(unknowns.size(), held ? 2 : 8);
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss;
    const Eigen::VectorXd y = Eigen::VectorXd::NullaryExpr(unknowns.size(), [&] { return gauss(random); });
    std::vector<Vector6d> twists(3, Vector6d::Zero());
    unknowns.scatterMotion(y, twists);
    Eigen::VectorXd all(18);
    all << twists[0], twists[1], twists[2];
    for (const int b : {1, 2}) EXPECT_LT((constraint(step, b) * all).norm(), 1e-12 * y.norm());
    EXPECT_LT((unknowns.gatherMotion(twists) - y).norm(), 1e-12 * y.norm());
    // Forces do the same work on both.
    std::vector<Vector6d> forces(3, Vector6d::Zero()), same(3, Vector6d::Zero());
    for (Vector6d& force : forces) force = Vector6d::NullaryExpr([&] { return gauss(random); });
    double work = 0.0;
    for (int b = held ? 1 : 0; b < 3; ++b) work += forces[b].dot(twists[b]);
    const Eigen::VectorXd f = unknowns.gatherForces(forces);
    EXPECT_NEAR(f.dot(y), work, 1e-12 * std::abs(work) + 1e-12);
    unknowns.scatterForces(f, same);
    EXPECT_LT((unknowns.gatherForces(same) - f).norm(), 1e-11 * f.norm());
  }
}

// The same step of bodies without joints, by their response to impulses, and by the joints' reactions.
TEST(JointedStep, IsThatOfFreeBodiesUnderConstraints) {
  for (const auto discretisation : {Discretisation::kFitted, Discretisation::kFractions}) {
    for (unsigned seed = 0; seed < kScenes; ++seed) {
      SCOPED_TRACE(seed);
      RandomStep jointed(seed, discretisation, BodyMotion::kFree, true);
      DirectSolver solver;
      solver.prepare(jointed.problem);
      StepVector with = jointed.start();
      ASSERT_EQ(solver.solve(jointed.rhs, closely(), with).status, SolveStatus::kConverged);

      const RandomStep described(seed, discretisation, BodyMotion::kFree, true);
      // The same random numbers, but for the joints.
      RandomStep loose(seed, discretisation, BodyMotion::kFree, true);
      for (RigidBody& body : loose.bodies) body.joint.reset();

      loose.problem.setUnknowns();
      solver.prepare(loose.problem);
      StepVector without = loose.start();
      ASSERT_EQ(solver.solve(loose.rhs, closely(), without).status, SolveStatus::kConverged);
      Eigen::MatrixXd K(18, 18);
      for (int i = 0; i < 18; ++i) {
        StepVector push = loose.start(), response = loose.start();
        push.bodies[i / 6][i % 6] = 1.0;
        ASSERT_EQ(solver.solve(push, closely(), response).status, SolveStatus::kConverged);
        K.col(i) << response.bodies[0], response.bodies[1], response.bodies[2];
      }
      Eigen::MatrixXd C(10, 18);
      C << constraint(described, 1), constraint(described, 2);
      Eigen::VectorXd v(18), w(18);
      v << without.bodies[0], without.bodies[1], without.bodies[2];
      w << with.bodies[0], with.bodies[1], with.bodies[2];
      EXPECT_GT((v - w).norm(), 1e-3 * w.norm()) << "joints do something";
      const Eigen::MatrixXd reach = C * K * C.transpose();
      v -= K * C.transpose() * reach.fullPivLu().solve(C * v);
      EXPECT_LT((v - w).norm(), 1e-5 * w.norm());
    }
  }
}

TEST(JointedStep, IsTheSameWhicheverWayItIsSolved) {
  int contacts = 0;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    RandomStep step(seed, Discretisation::kFitted, firstMotion(seed), true);
    step.problem.joint_resistance = {0.0, 0.3, 20.0};
    step.problem.setUnknowns();
    step.rows = buildContactRows(step.problem, step.contacts, std::vector<ContactLaw>(step.contacts.size(), {0.3, 0.0}),
                                 {}, 1.0);
    contacts += static_cast<int>(step.contacts.size());
    DirectSolver direct;
    FastSolver fast;
    ReferenceSolver reference;
    std::vector<StepVector> answers;
    CoupledOptions options = closely();
    options.tolerance = 1e-7;
    for (StepSolver* solver :
         {static_cast<StepSolver*>(&direct), static_cast<StepSolver*>(&fast), static_cast<StepSolver*>(&reference)}) {
      if (solver == &reference && step.number > 10.0) continue;  // it takes its time
      solver->prepare(step.problem);
      StepVector x = step.start();
      Eigen::VectorXd r;
      const CoupledReport report = solver->solveWithContacts(step.rhs, step.rows, options, x, r);
      ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message;
      answers.push_back(x);
    }
    StepVector x = step.start();
    Eigen::VectorXd r = Eigen::VectorXd::Zero(step.rows.J.rows());
    ASSERT_EQ(solveIteratively(direct, step.problem, step.rhs, step.rows, options, x, r).status,
              SolveStatus::kConverged);
    answers.push_back(x);
    const Eigen::VectorXd expected = step.problem.coordinates.gatherMotion(answers[0].bodies);
    for (const StepVector& other : answers) {
      const Eigen::VectorXd y = step.problem.coordinates.gatherMotion(other.bodies);
      EXPECT_LT((y - expected).norm(), 1e-5 * expected.norm());  // whatever the bodies weigh
    }
  }
  EXPECT_GT(contacts, 3);
}

// What a joint's resistance takes is the dissipation of that joint.
TEST(JointedStep, ResistanceIsAnImpulseAgainstTheJointsVelocity) {
  RandomStep step(1, Discretisation::kFitted, BodyMotion::kFree, true);
  StepVector x = step.start(), plain, resisted;
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  const Eigen::VectorXd y = Eigen::VectorXd::NullaryExpr(8, [&] { return gauss(random); });
  step.problem.coordinates.scatterMotion(y, x.bodies);
  StepVector same = x;
  step.problem.apply(x, plain);
  step.problem.joint_resistance = {0.0, 0.3, 0.7};
  step.problem.apply(same, resisted);
  const BodyCoordinates& unknowns = step.problem.coordinates;
  const Eigen::VectorXd change = unknowns.gatherForces(resisted.bodies) - unknowns.gatherForces(plain.bodies);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(8);
  for (const int b : {1, 2}) {
    const Eigen::VectorXd row = unknowns.jointRow(b);
    const double velocity = jointVelocity(step.bodies, b, same.bodies);
    EXPECT_NEAR(row.dot(y), velocity, 1e-12 * y.norm());
    expected += step.problem.joint_resistance[b] / step.problem.impulse_scale * velocity * row;
  }
  EXPECT_LT((change - expected).norm(), 1e-12 * (unknowns.gatherForces(plain.bodies).norm() + expected.norm()));
}

}  // namespace
}  // namespace monolith
