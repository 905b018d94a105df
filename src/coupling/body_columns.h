#pragma once
// The bodies' columns of the step over the liquid's unknowns: B = [A_uv; -C_v] as one sparse column block per free body,
// rows of six numbers, and the dense A_vv, from the rows of body_rows.h.

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <vector>

#include "coupling/step_problem.h"

namespace monolith {

// The liquid's unknowns: velocities by axes, then p^; lattice.size each.
template <class Real>
using LiquidFields = std::array<Real*, 4>;

// Where they follow each other.
template <class Real>
LiquidFields<Real> packedFields(const Lattice& lattice, Real* packed) {
  const auto size = static_cast<std::ptrdiff_t>(lattice.size);
  return {packed, packed + size, packed + 2 * size, packed + 3 * size};
}

template <class Real>
class BodyColumns {
 public:
  // In units of the twists divided by `scale`: columns and A_vv (without the bodies' inertia) are divided by it.
  void set(const StepProblem& problem, const Eigen::VectorXd& scale);
  template <class From>
  void convert(const BodyColumns<From>& from);

  // liquid += B v
  void addMotion(const Real* v, const LiquidFields<Real>& liquid) const;
  // liquid -= B v, bit for bit undone by giveBack() of what was there.
  void takeMotion(const Real* v, const LiquidFields<Real>& liquid, std::vector<Real>& before) const;
  void giveBack(const std::vector<Real>& before, const LiquidFields<Real>& liquid) const;
  // B^T liquid
  Eigen::VectorXd forces(const LiquidFields<const Real>& liquid) const;
  const Eigen::MatrixXd& ownResistance() const { return A_vv_; }

 private:
  template <class>
  friend class BodyColumns;
  struct Entry {
    std::int32_t place;  // in its field
    Real coefficient[6];
  };
  // Of the columns: faces of each axis, and cells. Different unknowns, so threads may take one each.
  static constexpr int kKinds = 4;

  std::size_t bodies() const { return begin_.size() / kKinds; }
  // f(entry, its number, its body) of a kind.
  template <class EntryFunction>
  void forEachOf(int kind, EntryFunction&& f) const {
    const std::size_t n = bodies();
    for (std::size_t b = 0; b < n; ++b) {
      for (std::size_t i = begin_[kind * n + b]; i < begin_[kind * n + b + 1]; ++i) f(entries_[i], i, b);
    }
  }
  static Real product(const Entry& entry, const Real* w) {
    const Real* k = entry.coefficient;
    return k[0] * w[0] + k[1] * w[1] + k[2] * w[2] + k[3] * w[3] + k[4] * w[4] + k[5] * w[5];
  }

  std::vector<Entry> entries_;      // by kinds, within them by bodies
  std::vector<std::size_t> begin_;  // of each kind and body; one more at the end
  Eigen::MatrixXd A_vv_;
};

}  // namespace monolith
