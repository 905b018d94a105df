// The paper's own matrix, A + J M_S^-1 J^T in stress and pressure, by its eigenvalues.

#include "coupling/stress_system.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scene/solid_body.h"

namespace monolith {
namespace {

// A tank of 4 x 4 x 5 cells, full or with a surface, with a free ball and a box that touches the wall.
struct SmallStep {
  SmallStep(Discretisation discretisation, double number, double fill) {
    MacGrid grid;
    grid.lattice = Lattice({4, 4, 5}, {false, false, false});
    grid.h = 0.1;
    const Lattice& l = grid.lattice;
    bodies.push_back(makeRigidBody(sphereBody("ball", 0.09, 500.0, {0.21, 0.19, 0.17}), grid.h));
    bodies.push_back(makeRigidBody(boxBody("box", {0.12, 0.11, 0.09}, 3000.0, {0.06, 0.2, 0.36}), grid.h));
    SolidSampler(grid).sample(bodies, solids);
    std::vector<double> liquid(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + 0.1 * i - fill;
      }
    }
    extendIntoHalo(l, liquid);
    constexpr double kDensity = 1000.0, kStep = 0.01;
    const double viscosity_of_one = kDensity * grid.h * grid.h / kStep;
    problem = std::make_unique<StepProblem>(grid, discretisation);
    problem->sticking_viscosity = 0.05 * viscosity_of_one;
    problem->assemble(solids, bodies, liquid, kDensity, number * viscosity_of_one, kStep);
  }
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::unique_ptr<StepProblem> problem;
};

class StressSystemTest : public testing::TestWithParam<Discretisation> {};

TEST_P(StressSystemTest, IsSymmetricAndPositiveButForSealedPressures) {
  for (const double number : {0.0, 0.01, 1.0, 100.0}) {
    for (const double fill : {3.4, 100.0}) {
      SCOPED_TRACE(testing::Message() << "number " << number << ", fill " << fill);
      const SmallStep step(GetParam(), number, fill);
      const StressSystem system(*step.problem);
      Eigen::MatrixXd inverse_inertia = Eigen::MatrixXd::Zero(system.J.cols(), system.J.cols());
      for (std::size_t i = 0; i < step.problem->free.size(); ++i) {
        inverse_inertia.block<6, 6>(6 * i, 6 * i) = step.problem->inertia[i].inverse();
      }
      const Eigen::MatrixXd J(system.J);
      ASSERT_GT(J.norm(), 0.0);
      const Eigen::MatrixXd whole = Eigen::MatrixXd(system.A) + J * inverse_inertia * J.transpose();
      EXPECT_EQ(system.stresses > 0, number > 0.0);
      EXPECT_LT((whole - whole.transpose()).cwiseAbs().maxCoeff(), 1e-13 * whole.cwiseAbs().maxCoeff());
      // By the diagonal, so that neither the stresses' nor the pressures' scale hides the other's.
      const Eigen::VectorXd scale = whole.diagonal().cwiseSqrt().cwiseInverse();
      ASSERT_TRUE(scale.allFinite());
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * whole * scale.asDiagonal(),
                                                                 Eigen::EigenvaluesOnly);
      const Eigen::VectorXd& values = eigen.eigenvalues();
      EXPECT_GT(values[0], -1e-12);
      const auto sealed = std::count_if(step.problem->regions.begin(), step.problem->regions.end(),
                                        [](const PressureRegion& region) { return region.null_mode; });
      EXPECT_EQ(sealed, fill > 10.0 ? 1 : 0);
      EXPECT_EQ((values.array() < 1e-10).count(), sealed);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Discretisations, StressSystemTest,
                         testing::Values(Discretisation::kFitted, Discretisation::kFractions), [](const auto& info) {
                           return info.param == Discretisation::kFitted ? "Fitted" : "Fractions";
                         });

}  // namespace
}  // namespace monolith
