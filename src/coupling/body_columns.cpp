#include "coupling/body_columns.h"

#include <array>
#include <cstdint>

#include "solve/index_table.h"
#include "solve/kernel_work.h"

namespace monolith {
namespace {

// Fewer entries are not worth waking a second thread for.
constexpr std::size_t kEntriesWorthSharing = 1000;

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

// Collects a field's columns entry by entry; what falls on the same unknown of the same body is summed.
template <class Real>
class BodyColumns<Real>::Collector {
 public:
  Collector(const StepProblem& problem, std::size_t most_entries, std::vector<Entry>& out)
      : problem_(problem), lattice_(problem.grid.lattice), table_(most_entries), out_(out) {
    out_.clear();
  }

  void addFace(int axis, std::ptrdiff_t face, int body, const Vector6d& coefficient) {
    const auto at = interior(face);
    if (problem_.coefficients.mass[axis][at] > 0.0) add(at, body, coefficient);
  }
  void add(std::ptrdiff_t place, int body, const Vector6d& coefficient) {
    const std::uint64_t key =
        static_cast<std::uint64_t>(place) * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(body);
    const std::int32_t i = table_.number(
        key ^ (key >> 32), [&](std::int32_t k) { return out_[k].place == place && out_[k].body == body; });
    if (i == static_cast<std::int32_t>(out_.size())) out_.push_back({static_cast<std::int32_t>(place), body, {}});
    for (int d = 0; d < 6; ++d) out_[i].coefficient[d] += static_cast<Real>(coefficient[d]);
  }

 private:
  // A face in the halo of a periodic axis is one inside.
  std::ptrdiff_t interior(std::ptrdiff_t f) const {
    const Lattice& l = lattice_;
    if (!l.anyPeriodic()) return f;
    std::array<int, 3> at = l.cell(f);
    for (int a = 0; a < 3; ++a) at[a] = l.wrapped(a, at[a]);
    return l.index(at[0], at[1], at[2]);
  }

  const StepProblem& problem_;
  const Lattice& lattice_;
  IndexTable table_;  // of out_
  std::vector<Entry>& out_;
};

// -C_v
template <class Real>
void BodyColumns<Real>::collectCells(const StepProblem& p) {
  Collector collector(p, p.rows.divergence.size(), entries_[3]);
  for (const BodyRow& row : p.rows.divergence) {
    if (p.free_index[row.body] >= 0) collector.add(row.sample, p.free_index[row.body], -row.coefficient);
  }
}

// A_uv
template <class Real>
void BodyColumns<Real>::collectFaces(const StepProblem& p, int axis) {
  const StaggeredCoefficients<double>& c = p.coefficients;
  if (!c.viscous) {
    entries_[axis].clear();
    return;
  }
  const Lattice& l = c.lattice;
  std::size_t most = 2 * p.rows.normal[axis].size() + p.rows.drag[axis].size();
  for (const auto& rows : p.rows.shear) most += 2 * rows.size();
  Collector collector(p, most, entries_[axis]);
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
}

template <>
void BodyColumns<double>::set(const StepProblem& p, const Eigen::VectorXd& scale) {
  if (p.free.empty()) {
    A_vv_.resize(0, 0);
    for (auto& field : entries_) field.clear();
    return;
  }
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  // Apart from each other: the fields, and A_vv.
#pragma omp parallel for schedule(dynamic)
  for (int part = 0; part <= kFields; ++part) {
    if (part == 0) {
      A_vv_ = inverse.asDiagonal() * findOwnResistance(p) * inverse.asDiagonal();
      continue;
    }
    const int field = part - 1;
    if (field < 3) {
      collectFaces(p, field);
    } else {
      collectCells(p);
    }
    for (Entry& entry : entries_[field]) {
      for (int d = 0; d < 6; ++d) entry.coefficient[d] *= inverse[6 * entry.body + d];
    }
  }
}

template <class Real>
template <class From>
void BodyColumns<Real>::convert(const BodyColumns<From>& from) {
  A_vv_ = from.A_vv_;
  for (int field = 0; field < kFields; ++field) {
    entries_[field].resize(from.entries_[field].size());
    for (std::size_t i = 0; i < entries_[field].size(); ++i) {
      const auto& other = from.entries_[field][i];
      Entry& entry = entries_[field][i];
      entry.place = other.place;
      entry.body = other.body;
      for (int d = 0; d < 6; ++d) entry.coefficient[d] = static_cast<Real>(other.coefficient[d]);
    }
  }
}

template <class Real>
std::size_t BodyColumns<Real>::count() const {
  return entries_[0].size() + entries_[1].size() + entries_[2].size() + entries_[3].size();
}

template <class Real>
void BodyColumns<Real>::addMotion(const Real* v, const LiquidFields<Real>& liquid) const {
  countWork(count(), 12.0, sizeof(Entry) + 2.0 * sizeof(Real));
#pragma omp parallel for schedule(dynamic) if (count() >= kEntriesWorthSharing)
  for (int field = 0; field < kFields; ++field) {
    Real* to = liquid[field];
    for (const Entry& entry : entries_[field]) to[entry.place] += entry.times(v);
  }
}

template <class Real>
void BodyColumns<Real>::takeMotion(const Real* v, const LiquidFields<Real>& liquid, LiquidPlaces<Real>& before) const {
  countWork(count(), 12.0, sizeof(Entry) + 3.0 * sizeof(Real));
#pragma omp parallel for schedule(dynamic) if (count() >= kEntriesWorthSharing)
  for (int field = 0; field < kFields; ++field) {
    Real* to = liquid[field];
    before[field].clear();
    for (const Entry& entry : entries_[field]) {
      before[field].push_back(to[entry.place]);
      to[entry.place] -= entry.times(v);
    }
  }
}

// Backwards: several bodies may have taken from one place, of which the first has seen what was there.
template <class Real>
void BodyColumns<Real>::giveBack(const LiquidPlaces<Real>& before, const LiquidFields<Real>& liquid) const {
  for (int field = 0; field < kFields; ++field) {
    for (std::size_t i = entries_[field].size(); i > 0; --i) {
      liquid[field][entries_[field][i - 1].place] = before[field][i - 1];
    }
  }
}

template <class Real>
Eigen::VectorXd BodyColumns<Real>::forces(const LiquidFields<const Real>& liquid) const {
  countWork(count(), 12.0, sizeof(Entry) + sizeof(Real));
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(A_vv_.rows(), kFields);
#pragma omp parallel for schedule(dynamic) if (count() >= kEntriesWorthSharing)
  for (int field = 0; field < kFields; ++field) {
    const Real* from = liquid[field];
    double* to = sums.col(field).data();
    for (const Entry& entry : entries_[field]) {
      const double x = from[entry.place];
      double* sum = to + 6 * entry.body;
      for (int d = 0; d < 6; ++d) sum[d] += entry.coefficient[d] * x;
    }
  }
  return sums.rowwise().sum();
}

template class BodyColumns<double>;
template void BodyColumns<float>::convert(const BodyColumns<double>&);
template void BodyColumns<float>::addMotion(const float*, const LiquidFields<float>&) const;
template Eigen::VectorXd BodyColumns<float>::forces(const LiquidFields<const float>&) const;

}  // namespace monolith
