#include "solve/fgmres.h"

#include <cmath>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// A cycle in single precision does not reduce the true residual by more than this.
constexpr double kLeastReduction = 3e-6;
// Below kFloor of where a cycle began, one that has gained next to nothing in kPatience iterations has met its precision.
constexpr double kFloor = 1e-4;
constexpr int kPatience = 4;
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

// x += sum_v coefficient[v] z[v]
void combine(const std::vector<std::vector<float>>& z, const Eigen::VectorXd& coefficient, std::vector<double>& x) {
  const auto size = static_cast<std::ptrdiff_t>(x.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t begin = 0; begin < size; begin += kSumBlock) {
    const auto end = std::min(size, begin + kSumBlock);
    for (int v = 0; v < coefficient.size(); ++v) {
      const float* q = z[v].data();
      const double a = coefficient[v];
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
  std::vector<double> estimates(kPatience, 1.0);
  int used = 0;
  bool stop = false;
  while (used < most && !stop) {
    const int j = used;
    room(basis_, j + 1);
    maps.precondition(basis_[j], room(directions_, j));
    std::vector<float>& w = basis_[j + 1];
    maps.apply_single(directions_[j], w);
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
    estimates.push_back(estimate);
    const bool stuck = estimate < kFloor && estimate > 0.95 * estimates[estimates.size() - 1 - kPatience];
    stop = estimate <= goal || stuck || !(length > 0.0) || !std::isfinite(estimate);
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
