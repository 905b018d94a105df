#include "solve/fgmres.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace monolith {
namespace {

class FgmresTest : public ::testing::Test {
 protected:
  FgmresTest() {
    std::mt19937 random(5);
    std::normal_distribution<double> gauss;
    const int n = 120;
    // Symmetric and indefinite, as the step's system is.
    const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return gauss(random); });
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(B).householderQ();
    Eigen::VectorXd eigenvalues(n);
    for (int i = 0; i < n; ++i) eigenvalues[i] = (i % 3 == 0 ? -1.0 : 1.0) * (1.0 + 0.2 * i);
    matrix = Q * eigenvalues.asDiagonal() * Q.transpose();
    rhs.resize(n);
    for (double& b : rhs) b = gauss(random);
  }
  LinearMap apply = [this](const std::vector<double>& x, std::vector<double>& y) {
    y.resize(x.size());
    Eigen::Map<Eigen::VectorXd>(y.data(), y.size()) = matrix * Eigen::Map<const Eigen::VectorXd>(x.data(), x.size());
  };
  double residual(const std::vector<double>& x) const {
    return (Eigen::Map<const Eigen::VectorXd>(rhs.data(), rhs.size()) -
            matrix * Eigen::Map<const Eigen::VectorXd>(x.data(), x.size()))
        .norm();
  }
  Eigen::MatrixXd matrix;
  std::vector<double> rhs;
};

TEST_F(FgmresTest, SolvesAnIndefiniteSystemAndReportsTheTrueResidual) {
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-9;
  options.maximum_iterations = 2000;
  options.restart = 130;
  const KrylovReport report = Fgmres().solve(
      apply, [](const auto& r, auto& z) { z = r; }, rhs, x, options);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(residual(x), 1e-9);
  EXPECT_NEAR(report.residual, residual(x), 1e-12);
}

TEST_F(FgmresTest, AnExactPreconditionerNeedsOneIteration) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(matrix);
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-8;
  const KrylovReport report = Fgmres().solve(
      apply,
      [&](const std::vector<double>& r, std::vector<double>& z) {
        z.resize(r.size());
        Eigen::Map<Eigen::VectorXd>(z.data(), z.size()) =
            lu.solve(Eigen::Map<const Eigen::VectorXd>(r.data(), r.size()));
      },
      rhs, x, options);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 1);
}

TEST_F(FgmresTest, SaysWhenItHasNotConverged) {
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-12;
  options.maximum_iterations = 3;
  const KrylovReport report = Fgmres().solve(
      apply, [](const auto& r, auto& z) { z = r; }, rhs, x, options);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NEAR(report.residual, residual(x), 1e-12);
}

TEST_F(FgmresTest, ASolutionAsTheGuessCostsNothing) {
  const Eigen::VectorXd exact = matrix.partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(rhs.data(), rhs.size()));
  std::vector<double> x(exact.data(), exact.data() + exact.size());
  KrylovOptions options;
  options.absolute_tolerance = 1e-8;
  EXPECT_EQ(Fgmres()
                .solve(
                    apply, [](const auto& r, auto& z) { z = r; }, rhs, x, options)
                .iterations,
            0);
}

}  // namespace
}  // namespace monolith
