#include "solve/fgmres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "solve/blocked_sum.h"
#include "solve/kernel_work.h"
#include "solve/whole_fields.h"

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
constexpr double kSingleRoundOff = 1e-5;  // of a norm

// What the next cycle in single precision is to reduce the residual by: as many as it takes share `wanted` equally,
// which takes the fewest directions at once.
double shareOfCycle(double wanted) {
  if (wanted >= 1.0) return 1.0;
  const double order = std::log(std::max(wanted, std::numeric_limits<double>::min()));
  return std::exp(order / std::ceil(order / std::log(kLeastReduction)));
}

std::size_t entries(const Parts& parts) {
  std::size_t sum = 0;
  for (const Part& part : parts) sum += static_cast<std::size_t>(part.end - part.begin);
  return sum;
}

// a.c, b.c, a.d, b.d at once: one sum alone would wait for its own additions.
template <class Real>
std::array<double, 4> fourProducts(const Real* a, const Real* b, const Real* c, const Real* d, std::ptrdiff_t size) {
  std::array<double, 4> total{};
  for (std::ptrdiff_t begin = 0; begin < size; begin += kChunk) {
    const auto end = std::min(size, begin + kChunk);
    Real ac = 0, bc = 0, ad = 0, bd = 0;
#pragma omp simd reduction(+ : ac, bc, ad, bd)
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      ac += a[i] * c[i];
      bc += b[i] * c[i];
      ad += a[i] * d[i];
      bd += b[i] * d[i];
    }
    total[0] += ac;
    total[1] += bc;
    total[2] += ad;
    total[3] += bd;
  }
  return total;
}

// Products of w and of the newest vector of the basis with all of it. One number and 4 flops an entry and vector, bound
// by memory; the blocks of w and of the newest stay in the first cache.
template <class Real>
void multiply(const Parts& parts, const std::vector<std::vector<Real>>& basis, int count, const std::vector<Real>& w,
              Eigen::VectorXd& with_w, Eigen::VectorXd& with_newest) {
  const auto blocks = static_cast<std::ptrdiff_t>(parts.size());
  Eigen::MatrixXd sums(2 * count, blocks);
  countWork(entries(parts), 4.0 * count, sizeof(Real) * (count + 1.0));
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    const std::ptrdiff_t begin = parts[b].begin, length = parts[b].end - begin;
    const Real *newest = basis[count - 1].data() + begin, *last = w.data() + begin;
    for (int i = 0; i < count; i += 2) {
      const int next = std::min(i + 1, count - 1);
      const std::array<double, 4> products =
          fourProducts(basis[i].data() + begin, basis[next].data() + begin, last, newest, length);
      sums(i, b) = products[0];
      sums(next, b) = products[1];
      sums(count + i, b) = products[2];
      sums(count + next, b) = products[3];
    }
  }
  Eigen::VectorXd total = Eigen::VectorXd::Zero(2 * count);
  for (std::ptrdiff_t b = 0; b < blocks; ++b) total += sums.col(b);
  with_w = total.head(count);
  with_newest = total.tail(count);
}

// w -= sum_i h[i] v_i; returns |w|^2. One number and 2 flops an entry and vector, bound by memory.
template <class Real>
double subtract(const Parts& parts, const std::vector<std::vector<Real>>& basis, const Eigen::VectorXd& h,
                std::vector<Real>& w) {
  const auto count = static_cast<double>(h.size());
  countWork(entries(parts), 2.0 * count + 2.0, sizeof(Real) * (count + 2.0));
  return blockedSum<double>(parts, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Real* to = w.data();
    for (Eigen::Index i = 0; i < h.size(); i += 2) {
      const bool pair = i + 1 < h.size();
      const Real *p = basis[i].data(), *q = basis[pair ? i + 1 : i].data();
      const Real a = static_cast<Real>(h[i]), b = static_cast<Real>(pair ? h[i + 1] : 0.0);
#pragma omp simd
      for (std::ptrdiff_t k = begin; k < end; ++k) to[k] -= a * p[k] + b * q[k];
    }
    return sumOfProducts(to + begin, to + begin, end - begin);
  });
}

// In double precision: the square of a small number may be none in single.
double sumOfSquares(const float* x, std::ptrdiff_t size) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::ptrdiff_t i = 0; i < size; ++i) sum += static_cast<double>(x[i]) * static_cast<double>(x[i]);
  return sum;
}

void addPart(const Parts& parts, std::size_t p, double a, const std::vector<double>& z, double* to) {
  const double* q = z.data() + parts[p].begin;
  const std::ptrdiff_t size = parts[p].end - parts[p].begin;
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < size; ++i) to[i] += a * q[i];
}
void addPart(const Parts& parts, std::size_t p, double a, const RoundedVector& z, double* to) {
  z.addTo(parts, p, a, to);
}

// x += sum_v coefficient[v] z[v]
template <class Direction>
void combine(const Parts& parts, const std::vector<Direction>& z, const Eigen::VectorXd& coefficient,
             const SplitVector& x) {
  const auto count = static_cast<double>(coefficient.size());
  const double bytes = std::is_same_v<Direction, RoundedVector> ? RoundedVector::bytes() : sizeof(double);
  countWork(entries(parts), 2.0 * count, bytes * count + 2.0 * sizeof(double));
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (int v = 0; v < coefficient.size(); ++v) addPart(parts, p, coefficient[v], z[v], x.at(parts[p].begin));
  }
}

void setZero(const Parts& parts, const SplitVector& x) {
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts.size(); ++p) std::fill_n(x.at(parts[p].begin), parts[p].end - parts[p].begin, 0.0);
}

template <class From, class To>
void scaleInto(const Parts& parts, const std::vector<From>& x, double a, std::vector<To>& y) {
  y.resize(x.size());
  countWork(entries(parts), 1.0, sizeof(From) + sizeof(To));
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const From* from = x.data();
    To* to = y.data();
#pragma omp simd
    for (std::ptrdiff_t i = parts[p].begin; i < parts[p].end; ++i) to[i] = static_cast<To>(a * from[i]);
  }
}

}  // namespace

template <class Real>
std::vector<Real>& Fgmres::Space<Real>::basisRoom(std::size_t index, std::size_t size) {
  if (basis.size() <= index) basis.resize(index + 1);
  for (; clean <= index; ++clean) assignZero(size, basis[clean]);
  // The length of a border may have changed.
  basis[index].resize(size, Real(0));
  return basis[index];
}

void Fgmres::forget() {
  single_.clean = double_.clean = 0;
  v_single_.clear();
  single_.z.clear();
  double_.z.clear();
}

void Fgmres::lose(const std::vector<std::ptrdiff_t>& begins, int length) {
  const auto clear = [&](auto& vector) {
    if (vector.empty()) return;
    for (const auto begin : begins) std::fill_n(vector.begin() + begin, length, 0);
  };
  const auto clearAll = [&](auto& space) {
    for (std::size_t i = 0; i < space.clean; ++i) clear(space.basis[i]);
    clear(space.z);
  };
  clearAll(single_);
  clearAll(double_);
  clear(v_single_);
}

const std::vector<float>& Fgmres::firstDirection(const KrylovMaps& maps, const SplitVector& x) {
  divide(maps);
  std::vector<float>& r = residualRoom(maps);
  std::vector<float>& z = single_.z;
  z.resize(maps.size, 0.0F);
  maps.residual(x, r);
  maps.precondition(r, z);
  return z;
}

double Fgmres::residual(const KrylovMaps& maps, const SplitVector& x) {
  maps.residual(x, residualRoom(maps));
  return residualNorm();
}

double Fgmres::completedResidual(const KrylovMaps& maps, const SplitVector& x) {
  maps.residual_rest(x, residualRoom(maps));
  return residualNorm();
}

double Fgmres::residualNorm() const {
  const float* r = single_.basis[0].data();
  countWork(entries(parts_), 2.0, sizeof(float));
  return std::sqrt(blockedSum<double>(
      parts_, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return sumOfSquares(r + begin, end - begin); }));
}

void Fgmres::divide(const KrylovMaps& maps) {
  parts_ = maps.parts;
  appendParts(static_cast<std::ptrdiff_t>(maps.rest), static_cast<std::ptrdiff_t>(maps.size), parts_);
}

void Fgmres::extend(const KrylovMaps& maps, bool known, std::vector<float>& v, RoundedVector& kept,
                    std::vector<float>& w) {
  std::vector<float>& z = single_.z;
  if (known) {
    maps.complete(v, z);
  } else {
    maps.precondition(v, z);
  }
  kept.take(parts_, static_cast<std::ptrdiff_t>(maps.rest), z);
  maps.apply_single(z, w);
}

// firstDirection() is in single precision.
void Fgmres::extend(const KrylovMaps& maps, bool, std::vector<double>& v, std::vector<double>& kept,
                    std::vector<double>& w) {
  std::vector<float>& z = single_.z;
  scaleInto(parts_, v, 1.0, v_single_);
  maps.precondition(v_single_, z);
  scaleInto(parts_, z, 1.0, double_.z);
  maps.apply(double_.z, w);
  kept = double_.z;
}

template <class Real>
int Fgmres::cycle(const KrylovMaps& maps, double norm, double goal, int most, bool first_known, Space<Real>& space,
                  const SplitVector& x) {
  constexpr bool single = std::is_same_v<Real, float>;
  Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(most, most);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(most + 1);
  std::vector<Eigen::JacobiRotation<double>> rotations(most);
  rhs[0] = 1.0;
  const std::size_t size = maps.size;
  scaleInto(parts_, single_.basis[0], 1.0 / norm, space.basisRoom(0, size));
  std::vector<double> estimates(kPatience, 1.0);
  int used = 0;
  bool stop = false;
  while (used < most && !stop) {
    const int j = used;
    std::vector<Real>& w = space.basisRoom(j + 1, size);
    if (space.directions.size() <= static_cast<std::size_t>(j)) space.directions.resize(j + 1);
    single_.z.resize(size, 0.0F);
    const bool known = first_known && j == 0;
    if (known) scaleInto(parts_, single_.z, 1.0 / norm, single_.z);
    extend(maps, known, space.basis[j], space.directions[j], w);
    // Modified Gram-Schmidt, whose coefficients are h = (I + L)^-1 V^T w with L the strictly lower part of V^T V
    // (Swirydowicz et al. 2021, Numer. Linear Algebra Appl. 28, e2343): it reads the basis twice, not four times.
    Eigen::VectorXd h, row;
    multiply(parts_, space.basis, j + 1, w, h, row);
    gram.row(j).head(j + 1) = row;
    gram.topLeftCorner(j + 1, j + 1).template triangularView<Eigen::UnitLower>().solveInPlace(h);
    const double length = std::sqrt(subtract(parts_, space.basis, h, w));
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
    if (length > 0.0) scaleInto(parts_, w, 1.0 / length, w);
  }
  const Eigen::VectorXd y =
      norm * hessenberg.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(rhs.head(used));
  if (y.allFinite()) combine(parts_, space.directions, y, x);
  return used;
}

KrylovReport Fgmres::solve(const KrylovMaps& maps, const SplitVector& x, const KrylovOptions& options,
                           KrylovPast past) {
  KrylovReport report;
  divide(maps);
  bool first_known = past == KrylovPast::kDirection;
  report.residual = past == KrylovPast::kNothing ? residual(maps, x) : completedResidual(maps, x);
  if (report.residual > (1.0 + kSingleRoundOff) * maps.right_norm) {
    // A guess that is worse than none: what it left wrong, where viscosities have changed by orders of magnitude, would
    // have to be taken back first.
    setZero(parts_, x);
    report.residual = residual(maps, x);
    first_known = false;
  }
  report.initial_residual = report.residual;
  const double target = std::max(options.absolute_tolerance, options.relative_tolerance * report.residual);
  report.converged = report.residual <= std::min(target, options.guess_tolerance);
  bool single = true;
  int length = std::min(options.shortest_cycle, options.longest_cycle);
  while (!report.converged && report.iterations < options.maximum_iterations && std::isfinite(report.residual)) {
    const double wanted = kMargin * target / report.residual;
    const double goal = single ? shareOfCycle(wanted) : wanted;
    const int most = std::min(length, options.maximum_iterations - report.iterations);
    const int used = single ? cycle(maps, report.residual, goal, most, first_known, single_, x)
                            : cycle(maps, report.residual, goal, most, false, double_, x);
    first_known = false;
    report.iterations += used;
    const double last = report.residual;
    report.residual = residual(maps, x);
    report.converged = report.residual <= target;
    if (report.converged) continue;
    if (used == most) {
      const bool poor = report.residual > kPoorCycle * last;
      // A long cycle for little: perhaps it is the precision.
      if (poor && length == options.longest_cycle) single = false;
      if (poor) length = std::min(2 * length, options.longest_cycle);
    } else if (single) {
      // It believed that it had arrived, or gave up: what is left is its round-off.
      single = report.residual <= kLost * goal * last;
    } else if (report.residual > 0.9 * last) {
      break;  // the floor of double precision: another cycle would not help
    }
  }
  return report;
}

}  // namespace monolith
