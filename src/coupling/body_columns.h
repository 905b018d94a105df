#pragma once
// The bodies' columns of the step over the liquid's unknowns: B = [A_uv; -C_v] as a list of rows of six numbers, each
// of one unknown and one free body, and the dense A_vv, from the rows of body_rows.h.

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <vector>

#include "coupling/step_problem.h"

namespace monolith {

// The liquid's unknowns: velocities by axes, then p^; lattice.size each.
template <class Real>
using LiquidFields = std::array<Real*, 4>;

// Values at some places of each.
template <class Real>
using LiquidPlaces = std::array<std::vector<Real>, 4>;

// The fields where they follow each other.
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
  void takeMotion(const Real* v, const LiquidFields<Real>& liquid, LiquidPlaces<Real>& before) const;
  void giveBack(const LiquidPlaces<Real>& before, const LiquidFields<Real>& liquid) const;
  // B^T liquid
  Eigen::VectorXd forces(const LiquidFields<const Real>& liquid) const;
  const Eigen::MatrixXd& ownResistance() const { return A_vv_; }

 private:
  template <class>
  friend class BodyColumns;
  struct Entry {
    std::int32_t place, body;  // in its field, among the free ones
    Real coefficient[6];

    Real times(const Real* motion) const {
      const Real *k = coefficient, *w = motion + 6 * body;
      return k[0] * w[0] + k[1] * w[1] + k[2] * w[2] + k[3] * w[3] + k[4] * w[4] + k[5] * w[5];
    }
  };
  class Collector;
  // Of each field: different unknowns, so threads may take one each.
  static constexpr int kFields = 4;

  // Of all fields.
  std::size_t count() const;
  void collectFaces(const StepProblem& problem, int axis);
  void collectCells(const StepProblem& problem);

  std::array<std::vector<Entry>, kFields> entries_;  // by first appearance
  Eigen::MatrixXd A_vv_;
};

}  // namespace monolith
