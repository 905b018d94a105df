#include "coupling/body_columns.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "solve/index_table.h"
#include "solve/kernel_work.h"

namespace monolith {
namespace {

// Fewer entries are not worth waking a second thread for.
constexpr std::size_t kEntriesWorthSharing = 1000;

struct Sum {
  std::int32_t place, body;
  Vector6d coefficient;
};

// Collects columns entry by entry; what falls on the same unknown of the same body is summed.
class Collector {
 public:
  Collector(const StepProblem& problem, std::size_t most_entries)
      : problem_(problem), lattice_(problem.grid.lattice), table_(most_entries) {}

  void addFace(int axis, std::ptrdiff_t face, int body, const Vector6d& coefficient) {
    const auto at = interior(face);
    if (!(problem_.coefficients.mass[axis][at] > 0.0)) return;
    add(at, body, coefficient);
  }
  void addCell(std::ptrdiff_t cell, int body, const Vector6d& coefficient) {
    add(cell, body, coefficient);
  }
  std::vector<Sum> take() { return std::move(sums_); }

 private:
  void add(std::ptrdiff_t place, int body, const Vector6d& coefficient) {
    const std::uint64_t key = static_cast<std::uint64_t>(place) * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(body);
    const std::int32_t i = table_.number(
        key ^ (key >> 32), [&](std::int32_t k) { return sums_[k].place == place && sums_[k].body == body; });
    if (i < static_cast<std::int32_t>(sums_.size())) {
      sums_[i].coefficient += coefficient;
    } else {
      sums_.push_back({static_cast<std::int32_t>(place), body, coefficient});
    }
  }
  // A face in the halo of a periodic axis is one inside.
  std::ptrdiff_t interior(std::ptrdiff_t f) const {
    const Lattice& l = lattice_;
    if (!l.anyPeriodic()) return f;
    std::array<int, 3> at = l.cell(f);
    for (int a = 0; a < 3; ++a) {
      if (l.periodic[a]) at[a] = (at[a] + l.n[a]) % l.n[a];
    }
    return l.index(at[0], at[1], at[2]);
  }

  const StepProblem& problem_;
  const Lattice& lattice_;
  IndexTable table_;  // of sums_
  std::vector<Sum> sums_;
};

// Of the cells: -C_v.
std::vector<Sum> collectCells(const StepProblem& p) {
  Collector collector(p, p.rows.divergence.size());
  for (const BodyRow& row : p.rows.divergence) {
    if (p.free_index[row.body] >= 0) collector.addCell(row.sample, p.free_index[row.body], -row.coefficient);
  }
  return collector.take();
}

// Of the faces of one axis: A_uv.
std::vector<Sum> collectFaces(const StepProblem& p, int axis) {
  const StaggeredCoefficients<double>& c = p.coefficients;
  if (!c.viscous) return {};
  const Lattice& l = c.lattice;
  std::size_t most = 2 * p.rows.normal[axis].size() + p.rows.drag[axis].size();
  for (const auto& rows : p.rows.shear) most += 2 * rows.size();
  Collector collector(p, most);
  for (const BodyRow& row : p.rows.normal[axis]) {
    const int body = p.free_index[row.body];
    if (body < 0) continue;
    const double weight = c.normal[axis][row.sample];
    collector.addFace(axis, row.sample + l.stride[axis], body, weight * row.coefficient);
    collector.addFace(axis, row.sample, body, -weight * row.coefficient);
  }
  for (int pair = 0; pair < 3; ++pair) {
    for (int place = 0; place < 2; ++place) {
      if (kShearPairs[pair][place] != axis) continue;
      const auto along = l.stride[kShearPairs[pair][1 - place]];
      for (const BodyRow& row : p.rows.shear[pair]) {
        const int body = p.free_index[row.body];
        if (body < 0) continue;
        const double weight = c.shear[pair][place][row.sample];
        collector.addFace(axis, row.sample, body, weight * row.coefficient);
        collector.addFace(axis, row.sample - along, body, -weight * row.coefficient);
      }
    }
  }
  for (const BodyRow& row : p.rows.drag[axis]) {
    const int body = p.free_index[row.body];
    if (body >= 0) collector.addFace(axis, row.sample, body, -c.drag[axis][row.sample] * row.coefficient);
  }
  return collector.take();
}

// A_vv
Eigen::MatrixXd findOwnResistance(const StepProblem& p) {
  const StaggeredCoefficients<double>& c = p.coefficients;
  const auto size = static_cast<Eigen::Index>(6 * p.free.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  const auto square = [&](const BodyRow* first, const BodyRow* last, double weight) {
    for (const BodyRow* r = first; r != last; ++r) {
      for (const BodyRow* q = first; q != last; ++q) {
        const int i = p.free_index[r->body], j = p.free_index[q->body];
        if (i >= 0 && j >= 0) A.block<6, 6>(6 * i, 6 * j) += weight * r->coefficient * q->coefficient.transpose();
      }
    }
  };
  for (int a = 0; a < 3 && c.viscous; ++a) {
    forEachSample(p.rows.normal[a],
                  [&](const BodyRow* first, const BodyRow* last) { square(first, last, c.normal[a][first->sample]); });
    forEachSample(p.rows.shear[a], [&](const BodyRow* first, const BodyRow* last) { square(first, last, 1.0); });
    for (const BodyRow& row : p.rows.drag[a]) square(&row, &row + 1, c.drag[a][row.sample]);
  }
  return A;
}

}  // namespace

template <>
void BodyColumns<double>::set(const StepProblem& p, const Eigen::VectorXd& scale) {
  const std::size_t n = p.free.size();
  begin_.assign(kKinds * n + 1, 0);
  if (n == 0) {
    A_vv_.resize(0, 0);
    entries_.clear();
    return;
  }
  // Apart from each other: the kinds of columns, and A_vv.
  std::array<std::vector<Sum>, kKinds> sums;
#pragma omp parallel for schedule(dynamic)
  for (int part = 0; part <= kKinds; ++part) {
    if (part == 0) A_vv_ = findOwnResistance(p);
    if (part > 0) sums[part - 1] = part < kKinds ? collectFaces(p, part - 1) : collectCells(p);
  }
  A_vv_ = (scale.cwiseInverse().asDiagonal() * A_vv_ * scale.cwiseInverse().asDiagonal()).eval();
  for (int kind = 0; kind < kKinds; ++kind) {
    for (const Sum& sum : sums[kind]) ++begin_[kind * n + sum.body + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  entries_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
#pragma omp parallel for schedule(dynamic)
  for (int kind = 0; kind < kKinds; ++kind) {
    for (const Sum& sum : sums[kind]) {
      Entry& entry = entries_[next[kind * n + sum.body]++];
      entry.place = sum.place;
      for (int d = 0; d < 6; ++d) entry.coefficient[d] = sum.coefficient[d] / scale[6 * sum.body + d];
    }
  }
}

template <class Real>
template <class From>
void BodyColumns<Real>::convert(const BodyColumns<From>& from) {
  begin_ = from.begin_;
  A_vv_ = from.A_vv_;
  entries_.resize(from.entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    entries_[i].place = from.entries_[i].place;
    for (int d = 0; d < 6; ++d) entries_[i].coefficient[d] = static_cast<Real>(from.entries_[i].coefficient[d]);
  }
}

template <class Real>
void BodyColumns<Real>::addMotion(const Real* v, const LiquidFields<Real>& liquid) const {
  countWork(entries_.size(), 12.0, sizeof(Entry) + 2.0 * sizeof(Real));
#pragma omp parallel for schedule(dynamic) if (entries_.size() >= kEntriesWorthSharing)
  for (int kind = 0; kind < kKinds; ++kind) {
    Real* field = liquid[kind];
    forEachOf(kind, [&](const Entry& entry, std::size_t, std::size_t b) {
      field[entry.place] += product(entry, v + 6 * b);
    });
  }
}

template <class Real>
void BodyColumns<Real>::takeMotion(const Real* v, const LiquidFields<Real>& liquid, std::vector<Real>& before) const {
  countWork(entries_.size(), 12.0, sizeof(Entry) + 3.0 * sizeof(Real));
  before.resize(entries_.size());
#pragma omp parallel for schedule(dynamic) if (entries_.size() >= kEntriesWorthSharing)
  for (int kind = 0; kind < kKinds; ++kind) {
    Real* field = liquid[kind];
    forEachOf(kind, [&](const Entry& entry, std::size_t i, std::size_t b) {
      before[i] = field[entry.place];
      field[entry.place] -= product(entry, v + 6 * b);
    });
  }
}

// Backwards: several bodies may have taken from one place, of which the first has seen what was there.
template <class Real>
void BodyColumns<Real>::giveBack(const std::vector<Real>& before, const LiquidFields<Real>& liquid) const {
  const std::size_t n = bodies();
  for (int kind = 0; kind < kKinds; ++kind) {
    for (std::size_t i = begin_[(kind + 1) * n]; i > begin_[kind * n]; --i) {
      liquid[kind][entries_[i - 1].place] = before[i - 1];
    }
  }
}

template <class Real>
Eigen::VectorXd BodyColumns<Real>::forces(const LiquidFields<const Real>& liquid) const {
  countWork(entries_.size(), 12.0, sizeof(Entry) + sizeof(Real));
  const std::size_t n = bodies();
  Eigen::MatrixXd sums(6 * n, kKinds);
#pragma omp parallel for schedule(dynamic) if (entries_.size() >= kEntriesWorthSharing)
  for (int kind = 0; kind < kKinds; ++kind) {
    const Real* field = liquid[kind];
    for (std::size_t b = 0; b < n; ++b) {
      double sum[6] = {};
      for (std::size_t i = begin_[kind * n + b]; i < begin_[kind * n + b + 1]; ++i) {
        const double x = field[entries_[i].place];
        for (int d = 0; d < 6; ++d) sum[d] += entries_[i].coefficient[d] * x;
      }
      for (int d = 0; d < 6; ++d) sums(6 * b + d, kind) = sum[d];
    }
  }
  return sums.rowwise().sum();
}

template class BodyColumns<double>;
template void BodyColumns<float>::convert(const BodyColumns<double>&);
template void BodyColumns<float>::addMotion(const float*, const LiquidFields<float>&) const;
template Eigen::VectorXd BodyColumns<float>::forces(const LiquidFields<const float>&) const;

}  // namespace monolith
