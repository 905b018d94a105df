#include "solve/refined_gmres.h"

#include <cmath>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// A cycle in single precision does not reduce the true residual by more than this.
constexpr double kLeastReduction = 3e-6;
// The estimate of a cycle may be a little off: aim lower than the goal.
constexpr double kMargin = 0.9;
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

// One step of modified Gram-Schmidt and the beginning of the next: w -= a v, then the product of w with `next` (which may be
// w itself). Classical Gram-Schmidt would read the basis as often and loses orthogonality after some ten vectors of this
// precision. 16 bytes and 4 flops an entry, bound by memory.
double subtract(const std::vector<float>* v, double a, const std::vector<float>& next, std::vector<float>& w) {
  const float factor = static_cast<float>(a);
  return blockedSum<double>(w.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (v != nullptr) {
      const float* q = v->data();
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) w[i] -= factor * q[i];
    }
    return sumOfProducts(next.data() + begin, w.data() + begin, end - begin);
  });
}

// x = sum_v coefficient[v] basis[v]
void combine(const std::vector<std::vector<float>>& basis, const Eigen::VectorXd& coefficient, std::vector<float>& x) {
  const auto size = static_cast<std::ptrdiff_t>(x.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t begin = 0; begin < size; begin += kSumBlock) {
    const auto end = std::min(size, begin + kSumBlock);
    std::fill(x.begin() + begin, x.begin() + end, 0.0f);
    for (int v = 0; v < coefficient.size(); ++v) {
      const float* q = basis[v].data();
      const auto a = static_cast<float>(coefficient[v]);
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) x[i] += a * q[i];
    }
  }
}

template <class Real>
void scaleInto(const std::vector<Real>& x, double a, std::vector<float>& y) {
  y.resize(x.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = static_cast<float>(a * x[i]);
}

}  // namespace

double RefinedGmres::residual(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x) {
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

Eigen::VectorXd RefinedGmres::cycle(const KrylovMaps& maps, double norm, double goal, int most) {
  Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(most + 1);
  std::vector<Eigen::JacobiRotation<double>> rotations(most);
  rhs[0] = 1.0;
  const auto room = [&](int index) -> std::vector<float>& {
    if (static_cast<int>(basis_.size()) <= index) basis_.resize(index + 1);
    // Zero where maps do not write.
    if (basis_[index].size() != work_.size()) basis_[index].assign(work_.size(), 0.0f);
    return basis_[index];
  };
  if (direction_.size() != work_.size()) direction_.assign(work_.size(), 0.0f);
  scaleInto(work_, 1.0 / norm, room(0));
  int used = 0;
  bool stop = false;
  while (used < most && !stop) {
    const int j = used;
    room(j + 1);
    maps.precondition(basis_[j], direction_);
    std::vector<float>& w = basis_[j + 1];
    maps.apply_single(direction_, w);
    Eigen::VectorXd h(j + 1);
    h[0] = subtract(nullptr, 0.0, basis_[0], w);
    for (int i = 0; i < j; ++i) h[i + 1] = subtract(&basis_[i], h[i], basis_[i + 1], w);
    const double length = std::sqrt(subtract(&basis_[j], h[j], w, w));
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

void RefinedGmres::correct(const KrylovMaps& maps, const Eigen::VectorXd& y, std::vector<double>& x) {
  // The vector after those that y speaks of has served.
  std::vector<float>& sum = basis_[y.size()];
  const double size = y.norm();  // keeps single precision in its range
  if (!(size > 0.0)) return;
  combine(basis_, y / size, sum);
  maps.precondition(sum, direction_);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += size * direction_[i];
}

KrylovReport RefinedGmres::solve(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x,
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
    correct(maps, y, x);
    const double last = report.residual;
    report.residual = residual(maps, b, x);
    report.converged = report.residual <= options.absolute_tolerance;
    // Round-off floor: another cycle would not help.
    if (!report.converged && report.residual > 0.9 * last && y.size() < most) break;
  }
  return report;
}

std::size_t RefinedGmres::bytes() const {
  std::size_t sum = work_.size() * sizeof(double) + direction_.size() * sizeof(float);
  for (const auto& v : basis_) sum += v.size() * sizeof(float);
  return sum;
}

}  // namespace monolith
