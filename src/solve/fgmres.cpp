#include "solve/fgmres.h"

#include <Eigen/Dense>
#include <cmath>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// Coefficients of w in the first `count` basis vectors, in one pass over memory.
Eigen::VectorXd project(const std::vector<std::vector<double>>& basis, int count, const std::vector<double>& w) {
  const auto size = static_cast<std::ptrdiff_t>(w.size());
  const std::ptrdiff_t blocks = (size + kSumBlock - 1) / kSumBlock;
  Eigen::MatrixXd sums(count, blocks);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    const auto begin = b * kSumBlock;
    const auto end = std::min(size, begin + kSumBlock);
    for (int v = 0; v < count; ++v) {
      const double* q = basis[v].data();
      double sum = 0.0;
#pragma omp simd reduction(+ : sum)
      for (std::ptrdiff_t i = begin; i < end; ++i) sum += q[i] * w[i];
      sums(v, b) = sum;
    }
  }
  Eigen::VectorXd total = Eigen::VectorXd::Zero(count);
  for (std::ptrdiff_t b = 0; b < blocks; ++b) total += sums.col(b);
  return total;
}

// w += sum_v coefficient[v] basis[v]
void combine(const std::vector<std::vector<double>>& basis, const Eigen::VectorXd& coefficient,
             std::vector<double>& w) {
  const auto size = static_cast<std::ptrdiff_t>(w.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t begin = 0; begin < size; begin += kSumBlock) {
    const auto end = std::min(size, begin + kSumBlock);
    for (int v = 0; v < coefficient.size(); ++v) {
      const double* q = basis[v].data();
      const double a = coefficient[v];
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) w[i] += a * q[i];
    }
  }
}

void scaleInto(const std::vector<double>& x, double a, std::vector<double>& y) {
  y.resize(x.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = a * x[i];
}

}  // namespace

KrylovReport Fgmres::solve(const LinearMap& apply, const LinearMap& precondition, const std::vector<double>& b,
                           std::vector<double>& x, const KrylovOptions& options) {
  KrylovReport report;
  const int restart = options.restart;
  const auto residual = [&] {
    work_.resize(b.size());
    apply(x, work_);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < b.size(); ++i) work_[i] = b[i] - work_[i];
    return std::sqrt(dot(work_, work_));
  };

  report.residual = report.initial_residual = residual();
  report.converged = report.residual <= options.absolute_tolerance;
  while (!report.converged && report.iterations < options.maximum_iterations && std::isfinite(report.residual)) {
    Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(restart + 1, restart);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(restart + 1);
    std::vector<Eigen::JacobiRotation<double>> rotations(restart);
    rhs[0] = report.residual;
    if (basis_.empty()) basis_.emplace_back();
    scaleInto(work_, 1.0 / report.residual, basis_[0]);
    int used = 0;
    bool stop = false;
    while (used < restart && report.iterations < options.maximum_iterations && !stop) {
      const int j = used;
      if (static_cast<int>(directions_.size()) <= j) directions_.emplace_back();
      if (static_cast<int>(basis_.size()) <= j + 1) basis_.emplace_back();
      directions_[j].resize(b.size());
      basis_[j + 1].resize(b.size());
      precondition(basis_[j], directions_[j]);
      std::vector<double>& w = basis_[j + 1];
      apply(directions_[j], w);
      const double before = std::sqrt(dot(w, w));
      Eigen::VectorXd h = project(basis_, j + 1, w);
      combine(basis_, -h, w);
      double norm = std::sqrt(dot(w, w));
      if (norm < 0.1 * before) {
        // Cancellation: orthogonalise once more (Daniel et al. 1976), or the recurrence drifts from the true residual.
        const Eigen::VectorXd again = project(basis_, j + 1, w);
        combine(basis_, -again, w);
        h += again;
        norm = std::sqrt(dot(w, w));
      }
      hessenberg.col(j).head(j + 1) = h;
      hessenberg(j + 1, j) = norm;
      for (int i = 0; i < j; ++i) hessenberg.col(j).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
      rotations[j].makeGivens(hessenberg(j, j), hessenberg(j + 1, j));
      hessenberg.col(j).applyOnTheLeft(j, j + 1, rotations[j].adjoint());
      rhs.applyOnTheLeft(j, j + 1, rotations[j].adjoint());
      ++used;
      ++report.iterations;
      const double estimate = std::abs(rhs[j + 1]);
      stop = estimate <= 0.9 * options.absolute_tolerance || !(norm > 0.0) || !std::isfinite(estimate);
      if (norm > 0.0) scaleInto(w, 1.0 / norm, w);
    }
    const Eigen::VectorXd y =
        hessenberg.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(rhs.head(used));
    if (!y.allFinite()) break;
    combine(directions_, y, x);
    const double last = report.residual;
    report.residual = residual();
    report.converged = report.residual <= options.absolute_tolerance;
    // Round-off floor: another cycle would not help.
    if (!report.converged && report.residual > 0.9 * last && used < restart) break;
  }
  return report;
}

}  // namespace monolith
