#include "coupling/body_columns.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "solve/index_table.h"
#include "solve/kernel_work.h"

namespace monolith {
namespace {

// Collects columns entry by entry; what falls on the same unknown of the same body is summed.
class Collector {
 public:
  explicit Collector(const StepProblem& problem)
      : problem_(problem), lattice_(problem.grid.lattice), table_(mostEntries(problem.rows)) {}

  struct Sum {
    std::int32_t place, body;
    Vector6d coefficient;
  };

  void addFace(int axis, std::ptrdiff_t face, int body, const Vector6d& coefficient) {
    const auto at = interior(face);
    if (!(problem_.coefficients.mass[axis][at] > 0.0)) return;
    add(axis * static_cast<std::ptrdiff_t>(lattice_.size) + at, body, coefficient);
  }
  void addCell(std::ptrdiff_t cell, int body, const Vector6d& coefficient) {
    add(3 * static_cast<std::ptrdiff_t>(lattice_.size) + cell, body, coefficient);
  }
  const std::vector<Sum>& sums() const { return sums_; }

 private:
  static std::size_t mostEntries(const BodyRows& rows) {
    std::size_t most = rows.divergence.size();
    for (int a = 0; a < 3; ++a) most += 2 * rows.normal[a].size() + 4 * rows.shear[a].size() + rows.drag[a].size();
    return most;
  }
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

// Calls f(first, last) for the rows of each sample, in order of the samples.
template <class GroupFunction>
void forEachSample(const std::vector<BodyRow>& rows, GroupFunction&& f) {
  const auto before = [](const BodyRow& a, const BodyRow& b) { return a.sample < b.sample; };
  std::vector<BodyRow> sorted;
  const std::vector<BodyRow>* in_order = &rows;
  if (!std::is_sorted(rows.begin(), rows.end(), before)) {
    sorted = rows;
    std::stable_sort(sorted.begin(), sorted.end(), before);
    in_order = &sorted;
  }
  for (std::size_t first = 0; first < in_order->size();) {
    std::size_t last = first;
    while (last < in_order->size() && (*in_order)[last].sample == (*in_order)[first].sample) ++last;
    f(in_order->data() + first, in_order->data() + last);
    first = last;
  }
}

}  // namespace

template <>
void BodyColumns<double>::set(const StepProblem& p, const Eigen::VectorXd& scale) {
  const StaggeredCoefficients<double>& c = p.coefficients;
  const Lattice& l = c.lattice;
  const auto n = static_cast<Eigen::Index>(p.free.size());
  A_vv_ = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  entries_.clear();
  begin_.assign(n + 1, 0);
  if (n == 0) return;
  Collector collector(p);
  const auto square = [&](const BodyRow* first, const BodyRow* last, double weight) {
    for (const BodyRow* r = first; r != last; ++r) {
      for (const BodyRow* q = first; q != last; ++q) {
        const int i = p.free_index[r->body], j = p.free_index[q->body];
        if (i >= 0 && j >= 0) A_vv_.block<6, 6>(6 * i, 6 * j) += weight * r->coefficient * q->coefficient.transpose();
      }
    }
  };
  for (const BodyRow& row : p.rows.divergence) {
    if (p.free_index[row.body] >= 0) collector.addCell(row.sample, p.free_index[row.body], -row.coefficient);
  }
  for (int a = 0; a < 3 && c.viscous; ++a) {
    forEachSample(p.rows.normal[a], [&](const BodyRow* first, const BodyRow* last) {
      const double weight = c.normal[a][first->sample];
      square(first, last, weight);
      for (const BodyRow* r = first; r != last; ++r) {
        const int body = p.free_index[r->body];
        if (body < 0) continue;
        collector.addFace(a, r->sample + l.stride[a], body, weight * r->coefficient);
        collector.addFace(a, r->sample, body, -weight * r->coefficient);
      }
    });
    forEachSample(p.rows.shear[a], [&](const BodyRow* first, const BodyRow* last) {
      square(first, last, 1.0);
      for (const BodyRow* r = first; r != last; ++r) {
        const int body = p.free_index[r->body];
        if (body < 0) continue;
        for (int place = 0; place < 2; ++place) {
          const int axis = kShearPairs[a][place];
          const double weight = c.shear[a][place][r->sample];
          collector.addFace(axis, r->sample, body, weight * r->coefficient);
          collector.addFace(axis, r->sample - l.stride[kShearPairs[a][1 - place]], body, -weight * r->coefficient);
        }
      }
    });
    for (const BodyRow& row : p.rows.drag[a]) {
      if (p.free_index[row.body] < 0) continue;
      square(&row, &row + 1, c.drag[a][row.sample]);
      collector.addFace(a, row.sample, p.free_index[row.body], -c.drag[a][row.sample] * row.coefficient);
    }
  }
  for (const auto& sum : collector.sums()) ++begin_[sum.body + 1];
  for (Eigen::Index b = 0; b < n; ++b) begin_[b + 1] += begin_[b];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  entries_.resize(collector.sums().size());
  for (const auto& sum : collector.sums()) {
    Entry& entry = entries_[next[sum.body]++];
    entry.place = sum.place;
    for (int d = 0; d < 6; ++d) entry.coefficient[d] = sum.coefficient[d] / scale[6 * sum.body + d];
  }
  A_vv_ = (scale.cwiseInverse().asDiagonal() * A_vv_ * scale.cwiseInverse().asDiagonal()).eval();
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
void BodyColumns<Real>::addMotion(const Real* v, Real* liquid) const {
  countWork(entries_.size(), 12.0, sizeof(Entry) + 2.0 * sizeof(Real));
  for (std::size_t b = 0; b + 1 < begin_.size(); ++b) {
    const Real* w = v + 6 * b;
    for (std::size_t i = begin_[b]; i < begin_[b + 1]; ++i) {
      const Real* k = entries_[i].coefficient;
      liquid[entries_[i].place] += k[0] * w[0] + k[1] * w[1] + k[2] * w[2] + k[3] * w[3] + k[4] * w[4] + k[5] * w[5];
    }
  }
}

template <class Real>
Eigen::VectorXd BodyColumns<Real>::forces(const Real* liquid) const {
  countWork(entries_.size(), 12.0, sizeof(Entry) + sizeof(Real));
  const std::size_t bodies = begin_.empty() ? 0 : begin_.size() - 1;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * bodies));
  for (std::size_t b = 0; b < bodies; ++b) {
    double sum[6] = {};
    for (std::size_t i = begin_[b]; i < begin_[b + 1]; ++i) {
      const double x = liquid[entries_[i].place];
      for (int d = 0; d < 6; ++d) sum[d] += entries_[i].coefficient[d] * x;
    }
    for (int d = 0; d < 6; ++d) out[6 * b + d] = sum[d];
  }
  return out;
}

template class BodyColumns<double>;
template void BodyColumns<float>::convert(const BodyColumns<double>&);
template void BodyColumns<float>::addMotion(const float*, float*) const;
template Eigen::VectorXd BodyColumns<float>::forces(const float*) const;

}  // namespace monolith
