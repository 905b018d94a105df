#include "solve/fgmres.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace monolith {
namespace {

constexpr double kRoundOff = 1e-7;  // of a residual that is kept in single precision

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
  // With the inverse as the preconditioner, or none.
  KrylovMaps maps(const Eigen::MatrixXd* inverse = nullptr) const {
    const auto times = [](const Eigen::MatrixXd& A, const auto& x, auto& y) {
      using Real = typename std::decay_t<decltype(x)>::value_type;
      using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
      Eigen::Map<Vector>(y.data(), y.size()) = A.cast<Real>() * Eigen::Map<const Vector>(x.data(), x.size());
    };
    return {rhs.size(),
            norm(rhs),
            [this](const SplitVector& x, std::vector<float>& r) {
              const Eigen::VectorXd left = residual(rhs, x.at(0));
              for (Eigen::Index i = 0; i < left.size(); ++i) r[i] = static_cast<float>(left[i]);
            },
            [this, times](auto& x, auto& y) { times(matrix, x, y); },
            [this, times](auto& x, auto& y) { times(matrix, x, y); },
            [inverse, times](auto& x, auto& y) {
              if (inverse != nullptr) {
                times(*inverse, x, y);
              } else {
                y = x;
              }
            }};
  }
  static double norm(const std::vector<double>& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), x.size()).norm();
  }
  static SplitVector whole(std::vector<double>& x) { return {{x.data()}, static_cast<std::ptrdiff_t>(x.size())}; }
  Eigen::VectorXd residual(const std::vector<double>& b, const double* x) const {
    const auto n = static_cast<Eigen::Index>(b.size());
    return Eigen::Map<const Eigen::VectorXd>(b.data(), n) - matrix * Eigen::Map<const Eigen::VectorXd>(x, n);
  }
  double residual(const std::vector<double>& x) const { return residual(rhs, x.data()).norm(); }
  Eigen::MatrixXd matrix;
  std::vector<double> rhs;
};

TEST_F(FgmresTest, SolvesAnIndefiniteSystemAndReportsTheTrueResidual) {
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-9;
  options.maximum_iterations = 2000;
  options.shortest_cycle = options.longest_cycle = 130;
  const KrylovReport report = Fgmres().solve(maps(), whole(x), options);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(residual(x), 1e-9);
  EXPECT_NEAR(report.residual, residual(x), kRoundOff * residual(x));
}

TEST_F(FgmresTest, AnExactPreconditionerNeedsOneIterationForEachCycleOfSinglePrecision) {
  const Eigen::MatrixXd inverse = matrix.inverse();
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-3 * residual(x);
  KrylovReport report = Fgmres().solve(maps(&inverse), whole(x), options);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 1);
  options.absolute_tolerance = 1e-10;
  report = Fgmres().solve(maps(&inverse), whole(x), options);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, 4);
}

TEST_F(FgmresTest, AGuessWithinTheToleranceIsImprovedOnceUnlessItIsFarCloser) {
  std::vector<double> x(rhs.size(), 0.0);
  const double start = residual(x);
  KrylovOptions options;
  options.absolute_tolerance = 2.0 * start;
  EXPECT_EQ(Fgmres().solve(maps(), whole(x), options).iterations, 0);
  options.guess_tolerance = 1.1 * start;
  EXPECT_EQ(Fgmres().solve(maps(), whole(x), options).iterations, 0);
  options.guess_tolerance = 0.9 * start;
  const KrylovReport report = Fgmres().solve(maps(), whole(x), options);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(residual(x), start);
}

TEST_F(FgmresTest, GoesOnFromAKnownFirstDirection) {
  KrylovOptions options;
  options.absolute_tolerance = 1e-8;
  options.maximum_iterations = 500;
  options.shortest_cycle = options.longest_cycle = 130;
  // The last ten entries of the right side and of the guess are others than those that the first direction was found
  // for. They may not tell in the others: none of the first ones is coupled to them.
  const Eigen::Index n = matrix.rows();
  matrix.topRightCorner(n - 10, 10).setZero();
  matrix.bottomLeftCorner(10, n - 10).setZero();
  std::vector<double> x(rhs.size());
  Eigen::Map<Eigen::VectorXd>(x.data(), n) = 0.5 * matrix.inverse() * Eigen::Map<const Eigen::VectorXd>(rhs.data(), n);
  std::vector<double> same = x;
  const KrylovReport report = Fgmres().solve(maps(), whole(x), options);
  KrylovMaps partly = maps();
  partly.rest = n - 10;
  appendParts(0, n - 10, partly.parts);
  std::vector<double> other = rhs;  // changes at the end only
  for (std::size_t i = other.size() - 10; i < other.size(); ++i) other[i] += 5.0;
  const std::vector<double>* right = &other;
  partly.residual_rest = [&](const SplitVector& from, std::vector<float>& to) {
    const Eigen::VectorXd left = residual(*right, from.at(0));
    for (Eigen::Index i = n - 10; i < n; ++i) to[i] = static_cast<float>(left[i]);
  };
  // How often the whole of a direction is asked for, and of a residual.
  int asked = 0, applied = 0;
  partly.residual = [&](const SplitVector& from, std::vector<float>& to) {
    ++applied;
    const Eigen::VectorXd left = residual(*right, from.at(0));
    for (Eigen::Index i = 0; i < n; ++i) to[i] = static_cast<float>(left[i]);
  };
  partly.precondition = [&asked, whole = partly.precondition](auto& from, auto& to) {
    ++asked;
    whole(from, to);
  };
  partly.complete = [](const std::vector<float>& from, std::vector<float>& to) {
    std::copy(from.end() - 10, from.end(), to.end() - 10);
  };
  Fgmres krylov;
  (void)krylov.firstDirection(partly, whole(same));
  right = &rhs;
  for (std::size_t i = same.size() - 10; i < same.size(); ++i) same[i] += 0.01;
  const KrylovReport going_on = krylov.solve(partly, whole(same), options, KrylovPast::kDirection);
  EXPECT_TRUE(going_on.converged);
  EXPECT_NEAR(going_on.iterations, report.iterations, 2);
  EXPECT_EQ(asked, going_on.iterations);
  EXPECT_LE(residual(same), 1e-8);
  EXPECT_NEAR(residual(same), going_on.residual, kRoundOff * residual(same));

  // From the residual that this has left.
  for (std::size_t i = rhs.size() - 10; i < rhs.size(); ++i) rhs[i] -= 2.0;
  applied = 0;
  KrylovOptions none = options;
  none.maximum_iterations = 0;
  EXPECT_NEAR(krylov.solve(partly, whole(same), none, KrylovPast::kResidual).residual, residual(same),
              kRoundOff * residual(same));
  EXPECT_EQ(applied, 0);
}

TEST_F(FgmresTest, StaysOrthogonalInSinglePrecision) {
  // Unrestarted, an iteration for each dimension is enough for a reduction that one cycle may reach; a basis that has
  // lost its orthogonality stagnates.
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-4 * residual(x);
  options.shortest_cycle = options.longest_cycle = 121;
  const KrylovReport report = Fgmres().solve(maps(), whole(x), options);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, 121);
}

// Between the parts that may hold unknowns nobody looks.
TEST_F(FgmresTest, LooksAtTheGivenPartsOnly) {
  KrylovOptions options;
  options.absolute_tolerance = 1e-8;
  options.maximum_iterations = 2000;
  options.shortest_cycle = options.longest_cycle = 130;
  const auto n = static_cast<std::ptrdiff_t>(rhs.size()), half = n / 2;
  std::vector<double> x(rhs.size(), 0.0);
  const KrylovReport together = Fgmres().solve(maps(), whole(x), options);
  // The first half lies 100 entries on, the second at the end, of the solution in another piece.
  constexpr std::ptrdiff_t kBefore = 100, kBetween = 6000;
  const auto place = [&](std::ptrdiff_t i) { return i < half ? kBefore + i : kBetween + i; };
  const auto times = [&](const auto& from, auto& to) {
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      double sum = 0.0;
      for (std::ptrdiff_t j = 0; j < n; ++j) sum += matrix(i, j) * from[place(j)];
      to[place(i)] = static_cast<typename std::decay_t<decltype(to)>::value_type>(sum);
    }
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> b(kBetween + n, none), found(kBetween, none), rest(half, 0.0);
  for (std::ptrdiff_t i = 0; i < n; ++i) b[place(i)] = rhs[i];
  std::fill_n(found.begin() + kBefore, half, 0.0);
  const SplitVector pieces{{found.data(), rest.data()}, kBetween + half};
  ASSERT_EQ(pieces.at(place(half)), rest.data());
  ASSERT_EQ(pieces.at(place(half - 1)), found.data() + place(half - 1));
  KrylovMaps apart{b.size(),
                   norm(rhs),
                   [&](const SplitVector& from, std::vector<float>& to) {
                     for (std::ptrdiff_t i = 0; i < n; ++i) {
                       double sum = rhs[i];
                       for (std::ptrdiff_t j = 0; j < n; ++j) sum -= matrix(i, j) * *from.at(place(j));
                       to[place(i)] = static_cast<float>(sum);
                     }
                   },
                   times,
                   times,
                   [&](auto& from, auto& to) {
                     for (std::ptrdiff_t i = 0; i < n; ++i) to[place(i)] = from[place(i)];
                   }};
  apart.rest = kBetween + half;
  appendParts(kBefore, kBefore + half, apart.parts);
  const KrylovReport report = Fgmres().solve(apart, pieces, options);
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.iterations, together.iterations, 0.1 * together.iterations);
  for (std::ptrdiff_t i = 0; i < n; ++i) EXPECT_NEAR(*pieces.at(place(i)), x[i], 1e-7);
}

// A surface has moved: what was an unknown of the last solve is none now, and nobody writes it any more.
TEST(Fgmres, NothingIsLeftOfUnknownsThatAreNoMore) {
  constexpr std::size_t kSize = 60;
  Fgmres krylov;
  int iterations[2] = {};
  for (const int stride : {1, 2}) {
    const auto scale = [stride](bool invert) {
      return [=](auto& x, auto& y) {
        for (std::size_t i = 0; i < kSize; i += stride) {
          const double d = i % 4 == 0 ? -1.0 - i : 1.0 + i;
          y[i] = invert ? x[i] / (d + 0.3) : x[i] * d;
        }
      };
    };
    krylov.forget();
    std::vector<double> b(kSize, 0.0), x(kSize, 0.0);
    for (std::size_t i = 0; i < kSize; i += stride) b[i] = std::cos(i);
    KrylovOptions options;
    options.absolute_tolerance = 1e-9;
    const auto left = [&](const SplitVector& from, std::vector<float>& to) {
      std::vector<double> times(kSize, 0.0);
      scale(false)(from.pieces[0], times);
      for (std::size_t i = 0; i < kSize; i += stride) to[i] = static_cast<float>(b[i] - times[i]);
    };
    const double size = std::sqrt(std::inner_product(b.begin(), b.end(), b.begin(), 0.0));
    const KrylovReport report = krylov.solve({kSize, size, left, scale(false), scale(false), scale(true)},
                                             {{x.data()}, static_cast<std::ptrdiff_t>(kSize)}, options);
    EXPECT_TRUE(report.converged) << report.residual;
    iterations[stride - 1] = report.iterations;
    for (std::size_t i = 0; i < kSize; ++i) {
      const double d = i % 4 == 0 ? -1.0 - i : 1.0 + i;
      EXPECT_NEAR(x[i], i % stride == 0 ? b[i] / d : 0.0, 1e-8);
    }
  }
  EXPECT_LE(iterations[1], iterations[0]);
}

TEST_F(FgmresTest, StopsAtAPartOfTheFirstResidualIfThatIsMore) {
  KrylovOptions options;
  options.absolute_tolerance = 1e-10;
  options.relative_tolerance = 0.03;
  std::vector<double> x(rhs.size(), 0.0);
  const KrylovReport rough = Fgmres().solve(maps(), whole(x), options);
  EXPECT_TRUE(rough.converged);
  EXPECT_LE(rough.residual, 0.03 * rough.initial_residual);
  EXPECT_GT(rough.residual, 1e-10);
  options.absolute_tolerance = 0.5 * rough.residual;
  options.relative_tolerance = 0.0;
  EXPECT_LE(Fgmres().solve(maps(), whole(x), options).residual, options.absolute_tolerance);
}

// More than single precision reaches in one cycle is reached in equal ones: no basis is longer than it has to be.
TEST_F(FgmresTest, CyclesShareAReductionEqually) {
  const Eigen::Index n = matrix.rows();
  std::mt19937 random(8);
  std::normal_distribution<double> gauss;
  const Eigen::MatrixXd nearly =
      matrix.inverse() *
      (Eigen::MatrixXd::Identity(n, n) + 0.02 * Eigen::MatrixXd::NullaryExpr(n, n, [&] { return gauss(random); }));
  std::vector<int> directions;  // of each cycle
  KrylovMaps counting = maps(&nearly);
  counting.residual = [&, plain = counting.residual](auto& x, auto& r) {
    directions.push_back(0);
    plain(x, r);
  };
  counting.precondition = [&, plain = counting.precondition](auto& x, auto& y) {
    ++directions.back();
    plain(x, y);
  };
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-8 * norm(rhs);
  EXPECT_TRUE(Fgmres().solve(counting, whole(x), options).converged);
  ASSERT_EQ(directions.size(), 3u);  // the last sees that it is done
  EXPECT_GE(directions[0], 4);
  EXPECT_NEAR(directions[0], directions[1], 2);
  EXPECT_EQ(directions[2], 0);
}

TEST_F(FgmresTest, SaysWhenItHasNotConverged) {
  std::vector<double> x(rhs.size(), 0.0);
  KrylovOptions options;
  options.absolute_tolerance = 1e-12;
  options.maximum_iterations = 3;
  const KrylovReport report = Fgmres().solve(maps(), whole(x), options);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NEAR(report.residual, residual(x), kRoundOff * residual(x));
}

TEST_F(FgmresTest, ASolutionAsTheGuessCostsNothing) {
  const Eigen::VectorXd exact = matrix.partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(rhs.data(), rhs.size()));
  std::vector<double> x(exact.data(), exact.data() + exact.size());
  KrylovOptions options;
  options.absolute_tolerance = 1e-8;
  EXPECT_EQ(Fgmres().solve(maps(), whole(x), options).iterations, 0);
}

}  // namespace
}  // namespace monolith
