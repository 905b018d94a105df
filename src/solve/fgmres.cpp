#include "solve/fgmres.h"

#include <cmath>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// A cycle in single precision does not reduce the true residual by more than this.
constexpr double kLeastReduction = 3e-6;
// The estimate of a cycle may be a little off: aim lower than the goal.
constexpr double kMargin = 0.9;
// Cancellation of this much costs orthogonality: once more (Daniel et al. 1976).
constexpr double kCancellation = 0.03;
constexpr std::ptrdiff_t kChunk = 512;  // terms of a sum in single precision

double sumOfProducts(const float* x, const float* y, std::ptrdiff_t size) {
  double total = 0.0;
  for (std::ptrdiff_t begin = 0; begin < size; begin += kChunk) {
    const auto end = std::min(size, begin + kChunk);
    float sum = 0.0f;
#pragma omp simd reduction(+ : sum)
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += x[i] * y[i];
    total += sum;
  }
  return total;
}

struct Projection {
  Eigen::VectorXd coefficients;
  double norm = 0.0;
};

// Coefficients of w in the first `count` basis vectors and |w|, in one pass over memory: 4 (count + 1) bytes and
// 2 (count + 1) flops an entry, bound by memory.
Projection project(const std::vector<std::vector<float>>& basis, int count, const std::vector<float>& w) {
  const auto size = static_cast<std::ptrdiff_t>(w.size());
  const std::ptrdiff_t blocks = (size + kSumBlock - 1) / kSumBlock;
  Eigen::MatrixXd sums(count + 1, blocks);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    const auto begin = b * kSumBlock;
    const auto length = std::min(size - begin, kSumBlock);
    for (int v = 0; v < count; ++v) sums(v, b) = sumOfProducts(basis[v].data() + begin, w.data() + begin, length);
    sums(count, b) = sumOfProducts(w.data() + begin, w.data() + begin, length);
  }
  Eigen::VectorXd total = Eigen::VectorXd::Zero(count + 1);
  for (std::ptrdiff_t b = 0; b < blocks; ++b) total += sums.col(b);
  return {total.head(count), std::sqrt(total[count])};
}

// w += sum_v coefficient[v] basis[v]; returns |w|.
template <class Real>
double combine(const std::vector<std::vector<float>>& basis, const Eigen::VectorXd& coefficient,
               std::vector<Real>& w) {
  return std::sqrt(blockedSum<double>(w.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (int v = 0; v < coefficient.size(); ++v) {
      const float* q = basis[v].data();
      const Real a = static_cast<Real>(coefficient[v]);
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) w[i] += a * q[i];
    }
    double sum = 0.0;
    for (std::ptrdiff_t i = begin; i < end; i += kChunk) {
      Real part = 0;
      const auto last = std::min(end, i + kChunk);
#pragma omp simd reduction(+ : part)
      for (std::ptrdiff_t q = i; q < last; ++q) part += w[q] * w[q];
      sum += part;
    }
    return sum;
  }));
}

template <class Real>
void scaleInto(const std::vector<Real>& x, double a, std::vector<float>& y) {
  y.resize(x.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = static_cast<float>(a * x[i]);
}

}  // namespace

double Fgmres::residual(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x) {
  work_.resize(b.size());
  maps.apply(x, work_);
  return std::sqrt(blockedSum<double>(b.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      work_[i] = b[i] - work_[i];
      sum += work_[i] * work_[i];
    }
    return sum;
  }));
}

Eigen::VectorXd Fgmres::cycle(const KrylovMaps& maps, double norm, double goal, int most) {
  Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(most + 1);
  std::vector<Eigen::JacobiRotation<double>> rotations(most);
  rhs[0] = 1.0;
  const auto room = [&](auto& vectors, int index) -> std::vector<float>& {
    if (static_cast<int>(vectors.size()) <= index) vectors.resize(index + 1);
    if (vectors[index].size() != work_.size()) vectors[index].assign(work_.size(), 0.0f);
    return vectors[index];
  };
  scaleInto(work_, 1.0 / norm, room(basis_, 0));
  int used = 0;
  bool stop = false;
  while (used < most && !stop) {
    const int j = used;
    room(basis_, j + 1);
    maps.precondition(basis_[j], room(directions_, j));
    std::vector<float>& w = basis_[j + 1];
    maps.apply_single(directions_[j], w);
    const Projection p = project(basis_, j + 1, w);
    Eigen::VectorXd h = p.coefficients;
    double length = combine(basis_, -h, w);
    if (length < kCancellation * p.norm) {
      const Eigen::VectorXd again = project(basis_, j + 1, w).coefficients;
      length = combine(basis_, -again, w);
      h += again;
    }
    hessenberg.col(j).head(j + 1) = h;
    hessenberg(j + 1, j) = length;
    for (int i = 0; i < j; ++i) hessenberg.col(j).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
    rotations[j].makeGivens(hessenberg(j, j), hessenberg(j + 1, j));
    hessenberg.col(j).applyOnTheLeft(j, j + 1, rotations[j].adjoint());
    rhs.applyOnTheLeft(j, j + 1, rotations[j].adjoint());
    ++used;
    const double estimate = std::abs(rhs[j + 1]);
    stop = estimate <= goal || !(length > 0.0) || !std::isfinite(estimate);
    if (length > 0.0) scaleInto(w, 1.0 / length, w);
  }
  return norm * hessenberg.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(rhs.head(used));
}

KrylovReport Fgmres::solve(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x,
                           const KrylovOptions& options) {
  KrylovReport report;
  report.residual = report.initial_residual = residual(maps, b, x);
  report.converged = report.residual <= options.absolute_tolerance;
  while (!report.converged && report.iterations < options.maximum_iterations && std::isfinite(report.residual)) {
    const double goal = std::max(kMargin * options.absolute_tolerance / report.residual, kLeastReduction);
    const int most = std::min(options.restart, options.maximum_iterations - report.iterations);
    const Eigen::VectorXd y = cycle(maps, report.residual, goal, most);
    report.iterations += static_cast<int>(y.size());
    if (!y.allFinite()) break;
    combine(directions_, y, x);
    const double last = report.residual;
    report.residual = residual(maps, b, x);
    report.converged = report.residual <= options.absolute_tolerance;
    // Round-off floor: another cycle would not help.
    if (!report.converged && report.residual > 0.9 * last && y.size() < most) break;
  }
  return report;
}

std::size_t Fgmres::bytes() const {
  std::size_t sum = work_.size() * sizeof(double);
  for (const auto* vectors : {&basis_, &directions_}) {
    for (const auto& v : *vectors) sum += v.size() * sizeof(float);
  }
  return sum;
}

}  // namespace monolith
