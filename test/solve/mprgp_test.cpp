#include "solve/mprgp.h"

#include <gtest/gtest.h>

#include <random>

#include "solve/lcp.h"

namespace monolith {
namespace {

TEST(Mprgp, AgreesWithTheSolutionByPivoting) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::Index n = 12, unconstrained = trial % 3 == 0 ? 0 : 5;
    Eigen::MatrixXd B(n, n);
    for (Eigen::Index i = 0; i < B.size(); ++i) B.data()[i] = normal(random);
    const Eigen::MatrixXd A = B * B.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd b(n);
    for (double& x : b) x = normal(random);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    MprgpOptions options;
    options.tolerance = 1e-11;
    const MprgpReport report =
        solveMprgp([&](const auto& from, auto& to) { to = A * from; },
                   [&](const auto& from, auto& to) { to = from.cwiseQuotient(A.diagonal().head(from.size())); },
                   A.trace(), b, unconstrained, options, x);
    ASSERT_TRUE(report.converged) << report.residual;
    // Oracle: the unconstrained entries eliminated, the rest a linear complementarity problem.
    const Eigen::Index m = n - unconstrained;
    const Eigen::MatrixXd F = A.topLeftCorner(unconstrained, unconstrained);
    const Eigen::MatrixXd C = A.topRightCorner(unconstrained, m);
    Eigen::MatrixXd S = A.bottomRightCorner(m, m);
    Eigen::VectorXd q = -b.tail(m);
    if (unconstrained > 0) {
      S -= C.transpose() * F.ldlt().solve(C);
      q += C.transpose() * F.ldlt().solve(b.head(unconstrained));
    }
    Eigen::VectorXd y;
    ASSERT_TRUE(solveLcp(S, q, y).solved);
    EXPECT_LT((x.tail(m) - y).norm(), 1e-7 * (1.0 + y.norm()));
    if (unconstrained > 0) {
      EXPECT_LT((x.head(unconstrained) - F.ldlt().solve(b.head(unconstrained) - C * y)).norm(), 1e-6);
    }
  }
}

TEST(Mprgp, ReportsThatItHasNotConverged) {
  const Eigen::MatrixXd A = Eigen::Vector3d(1.0, 1e3, 1e6).asDiagonal();
  Eigen::VectorXd x = Eigen::Vector3d::Zero();
  MprgpOptions options;
  options.tolerance = 1e-12;
  options.maximum_iterations = 2;
  const MprgpReport report =
      solveMprgp([&](const auto& from, auto& to) { to = A * from; }, [&](const auto& from, auto& to) { to = from; },
                 1e6, Eigen::Vector3d(1, -2, 3), 1, options, x);
  EXPECT_FALSE(report.converged);
}

}  // namespace
}  // namespace monolith
