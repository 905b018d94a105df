#include "solve/lcp.h"

#include <gtest/gtest.h>

#include <random>

namespace monolith {
namespace {

// The solution by trying every set of active rows.
Eigen::VectorXd enumerated(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
  const int n = static_cast<int>(q.size());
  for (int bits = 0; bits < (1 << n); ++bits) {
    std::vector<int> set;
    for (int i = 0; i < n; ++i) {
      if (bits & (1 << i)) set.push_back(i);
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    if (!set.empty()) x(set) = M(set, set).fullPivLu().solve(-q(set));
    if (x.minCoeff() >= -1e-10 && (M * x + q).minCoeff() >= -1e-10) return x;
  }
  return Eigen::VectorXd::Constant(n, std::nan(""));
}

TEST(Lcp, AgreesWithEnumeration) {
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % 9;
    const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return gauss(random); });
    const Eigen::MatrixXd M = B * B.transpose() + 0.05 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, [&] { return gauss(random); });
    Eigen::VectorXd x;
    ASSERT_TRUE(solveLcp(M, q, x).solved);
    EXPECT_LT((x - enumerated(M, q)).norm(), 1e-8 * (1.0 + x.norm()));
  }
}

TEST(Lcp, FourCornersOfABoxShareItsWeight) {
  // Four contacts on one body of three vertical degrees of freedom: singular but for the regularisation.
  Eigen::MatrixXd J(4, 3);
  J << 1, 1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  Eigen::MatrixXd M = J * J.transpose();
  M.diagonal().array() += 1e-8;
  Eigen::VectorXd x;
  ASSERT_TRUE(solveLcp(M, Eigen::VectorXd::Constant(4, -1.0), x).solved);
  EXPECT_NEAR(x.sum(), 1.0, 1e-6);
  EXPECT_NEAR(x.maxCoeff(), x.minCoeff(), 1e-6);
}

TEST(Lcp, LargeProblemsAreComplementary) {
  std::mt19937 random(2);
  std::normal_distribution<double> gauss;
  const int n = 80;
  const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(n, 30, [&] { return gauss(random); });
  Eigen::MatrixXd M = J * J.transpose();
  M.diagonal().array() += 1e-6;
  const Eigen::VectorXd q = J * Eigen::VectorXd::NullaryExpr(30, [&] { return gauss(random); });
  Eigen::VectorXd x;
  ASSERT_TRUE(solveLcp(M, q, x).solved);
  const Eigen::VectorXd w = M * x + q;
  EXPECT_GE(x.minCoeff(), 0.0);
  EXPECT_GE(w.minCoeff(), -1e-6);
  EXPECT_LT(std::abs(x.dot(w)), 1e-6 * (1.0 + x.norm()));
}

}  // namespace
}  // namespace monolith
