#include "solve/fgmres.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "solve/blocked_sum.h"

namespace monolith {
namespace {

// A cycle in single precision does not reduce the true residual by more than this.
constexpr double kLeastReduction = 3e-6;
// Below kFloor of where a cycle began, one that has gained next to nothing in kPatience iterations has met its
// precision.
constexpr double kFloor = 1e-4;
constexpr int kPatience = 4;
// One that ends at more than this times its goal was misled by its precision.
constexpr double kLost = 2.0;
constexpr double kPoorCycle = 0.1;
// The estimate of a cycle may be a little off: aim lower than the goal.
constexpr double kMargin = 0.9;
constexpr std::ptrdiff_t kChunk = 512;  // terms of a sum in single precision

template <class Real>
double sumOfProducts(const Real* x, const Real* y, std::ptrdiff_t size) {
  double total = 0.0;
  for (std::ptrdiff_t begin = 0; begin < size; begin += kChunk) {
    const auto end = std::min(size, begin + kChunk);
    Real sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::ptrdiff_t i = begin; i < end; ++i) sum += x[i] * y[i];
    total += sum;
  }
  return total;
}

// One step of modified Gram-Schmidt and the beginning of the next: w -= a v, then the product of w with `next` (which
// may be w itself). Classical Gram-Schmidt would read the basis as often and loses orthogonality after some ten vectors
// of single precision. 4 numbers and 4 flops an entry, bound by memory.
template <class Real>
double subtract(const std::vector<Real>* v, double a, const std::vector<Real>& next, std::vector<Real>& w) {
  const Real factor = static_cast<Real>(a);
  return blockedSum<double>(w.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (v != nullptr) {
      const Real* q = v->data();
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) w[i] -= factor * q[i];
    }
    return sumOfProducts(next.data() + begin, w.data() + begin, end - begin);
  });
}

// x += sum_v coefficient[v] z[v]
template <class Real>
void combine(const std::vector<std::vector<Real>>& z, const Eigen::VectorXd& coefficient, std::vector<double>& x) {
  const auto size = static_cast<std::ptrdiff_t>(x.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t begin = 0; begin < size; begin += kSumBlock) {
    const auto end = std::min(size, begin + kSumBlock);
    for (int v = 0; v < coefficient.size(); ++v) {
      const Real* q = z[v].data();
      const double a = coefficient[v];
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) x[i] += a * q[i];
    }
  }
}

template <class From, class To>
void scaleInto(const std::vector<From>& x, double a, std::vector<To>& y) {
  y.resize(x.size());
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = static_cast<To>(a * x[i]);
}

}  // namespace

double Fgmres::residual(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x) {
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

// z = P^-1 v, w = A z.
void Fgmres::extend(const KrylovMaps& maps, std::vector<float>& v, std::vector<float>& z, std::vector<float>& w) {
  maps.precondition(v, z);
  maps.apply_single(z, w);
}

void Fgmres::extend(const KrylovMaps& maps, std::vector<double>& v, std::vector<double>& z, std::vector<double>& w) {
  scaleInto(v, 1.0, v_single_);
  z_single_.resize(v.size(), 0.0f);
  maps.precondition(v_single_, z_single_);
  scaleInto(z_single_, 1.0, z);
  maps.apply(z, w);
}

template <class Real>
int Fgmres::cycle(const KrylovMaps& maps, double norm, double goal, int most, Space<Real>& space,
                  std::vector<double>& x) {
  constexpr bool single = std::is_same_v<Real, float>;
  Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(most + 1);
  std::vector<Eigen::JacobiRotation<double>> rotations(most);
  rhs[0] = 1.0;
  // The unknowns may be others than those of the last solve, of which nothing may be left.
  const auto room = [&](auto& vectors, std::size_t& clean, std::size_t index) -> std::vector<Real>& {
    if (vectors.size() <= index) vectors.resize(index + 1);
    for (; clean <= index; ++clean) vectors[clean].assign(work_.size(), Real(0));
    return vectors[index];
  };
  scaleInto(work_, 1.0 / norm, room(space.basis, space.clean_basis, 0));
  std::vector<double> estimates(kPatience, 1.0);
  int used = 0;
  bool stop = false;
  while (used < most && !stop) {
    const int j = used;
    room(space.basis, space.clean_basis, j + 1);
    std::vector<Real>& w = space.basis[j + 1];
    extend(maps, space.basis[j], room(space.directions, space.clean_directions, j), w);
    Eigen::VectorXd h(j + 1);
    h[0] = subtract<Real>(nullptr, 0.0, space.basis[0], w);
    for (int i = 0; i < j; ++i) h[i + 1] = subtract(&space.basis[i], h[i], space.basis[i + 1], w);
    const double length = std::sqrt(subtract(&space.basis[j], h[j], w, w));
    hessenberg.col(j).head(j + 1) = h;
    hessenberg(j + 1, j) = length;
    for (int i = 0; i < j; ++i) hessenberg.col(j).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
    rotations[j].makeGivens(hessenberg(j, j), hessenberg(j + 1, j));
    hessenberg.col(j).applyOnTheLeft(j, j + 1, rotations[j].adjoint());
    rhs.applyOnTheLeft(j, j + 1, rotations[j].adjoint());
    ++used;
    const double estimate = std::abs(rhs[j + 1]);
    estimates.push_back(estimate);
    const bool stuck = single && estimate < kFloor && estimate > 0.95 * estimates[estimates.size() - 1 - kPatience];
    stop = estimate <= goal || stuck || !(length > 0.0) || !std::isfinite(estimate);
    if (length > 0.0) scaleInto(w, 1.0 / length, w);
  }
  const Eigen::VectorXd y =
      norm * hessenberg.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(rhs.head(used));
  if (y.allFinite()) combine(space.directions, y, x);
  return used;
}

KrylovReport Fgmres::solve(const KrylovMaps& maps, const std::vector<double>& b, std::vector<double>& x,
                           const KrylovOptions& options) {
  KrylovReport report;
  single_.clean_basis = single_.clean_directions = 0;
  double_.clean_basis = double_.clean_directions = 0;
  work_.assign(b.size(), 0.0);
  z_single_.assign(double_.basis.empty() ? 0 : b.size(), 0.0f);
  report.residual = residual(maps, b, x);
  const double none = std::sqrt(dot(b, b));
  if (report.residual > none) {
    // A guess that is worse than none: what it left wrong, where viscosities have changed by orders of magnitude, would
    // have to be taken back first.
    std::fill(x.begin(), x.end(), 0.0);
    work_ = b;
    report.residual = none;
  }
  report.initial_residual = report.residual;
  report.converged = report.residual <= options.absolute_tolerance;
  bool single = true;
  while (!report.converged && report.iterations < options.maximum_iterations && std::isfinite(report.residual)) {
    const double wanted = kMargin * options.absolute_tolerance / report.residual;
    const double goal = single ? std::max(wanted, kLeastReduction) : wanted;
    const int most = std::min(options.restart, options.maximum_iterations - report.iterations);
    const int used = single ? cycle(maps, report.residual, goal, most, single_, x)
                            : cycle(maps, report.residual, goal, most, double_, x);
    report.iterations += used;
    const double last = report.residual;
    report.residual = residual(maps, b, x);
    report.converged = report.residual <= options.absolute_tolerance;
    if (report.converged) continue;
    if (used == most) {
      // A whole cycle for little: perhaps it is the precision.
      single = single && report.residual <= kPoorCycle * last;
    } else if (single) {
      // It believed that it had arrived, or gave up: what is left is its round-off.
      single = report.residual <= kLost * goal * last;
    } else if (report.residual > 0.9 * last) {
      break;  // the floor of double precision: another cycle would not help
    }
  }
  return report;
}

std::size_t Fgmres::bytes() const {
  std::size_t sum = work_.size() * sizeof(double);
  for (const auto* vectors : {&single_.basis, &single_.directions}) {
    for (const auto& v : *vectors) sum += v.size() * sizeof(float);
  }
  for (const auto* vectors : {&double_.basis, &double_.directions}) {
    for (const auto& v : *vectors) sum += v.size() * sizeof(double);
  }
  return sum;
}

}  // namespace monolith
