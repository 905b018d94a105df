#include "solve/anderson.h"

#include <Eigen/Dense>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// Directions that the others already span to this part are left out.
constexpr double kRankTolerance = 1e-7;

double sumOfThree(const double* weight, const double* a, const double* b, std::ptrdiff_t size) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::ptrdiff_t i = 0; i < size; ++i) sum += weight[i] * a[i] * b[i];
  return sum;
}

double weightedDot(const std::vector<double>& weight, const std::vector<double>& a, const std::vector<double>& b) {
  return blockedSum<double>(static_cast<std::ptrdiff_t>(a.size()), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return sumOfThree(weight.data() + begin, a.data() + begin, b.data() + begin, end - begin);
  });
}

}  // namespace

void Anderson::forget() {
  last_y_.clear();
  dy_.clear();
  df_.clear();
}

void Anderson::advance(const std::vector<double>& image, const std::vector<double>& weight, std::vector<double>& y) {
  const auto size = static_cast<std::ptrdiff_t>(y.size());
  std::vector<double> f(y.size());
#pragma omp parallel for simd schedule(static)
  for (std::ptrdiff_t i = 0; i < size; ++i) f[i] = image[i] - y[i];
  if (!last_y_.empty()) {
    std::vector<double> dy(y.size()), df(y.size());
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      dy[i] = y[i] - last_y_[i];
      df[i] = f[i] - last_f_[i];
    }
    if (static_cast<int>(dy_.size()) == depth_) {
      dy_.erase(dy_.begin());
      df_.erase(df_.begin());
    }
    dy_.push_back(std::move(dy));
    df_.push_back(std::move(df));
  }
  last_y_ = y;
  last_f_ = f;

  const auto count = static_cast<Eigen::Index>(df_.size());
  Eigen::MatrixXd gram(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = a; b < count; ++b) gram(a, b) = gram(b, a) = weightedDot(weight, df_[a], df_[b]);
    right[a] = weightedDot(weight, df_[a], f);
  }
  // Each difference in its own length, or the first and longest one hides the others.
  Eigen::VectorXd length = gram.diagonal().cwiseSqrt();
  for (double& l : length) l = l > 0.0 ? 1.0 / l : 0.0;
  const Eigen::MatrixXd scaled = length.asDiagonal() * gram * length.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> least_squares;
  least_squares.setThreshold(kRankTolerance);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(count);
  if (count > 0) {
    least_squares.compute(scaled);
    theta = length.cwiseProduct(least_squares.solve(length.cwiseProduct(right)));
  }
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    double next = y[i] + damping_ * f[i];
    for (Eigen::Index a = 0; a < count; ++a) next -= theta[a] * (dy_[a][i] + damping_ * df_[a][i]);
    y[i] = next;
  }
}

}  // namespace monolith
