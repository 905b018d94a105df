#pragma once
// The bodies' columns of the step over packed unknowns (packed_system.h): B = [A_uv; -C_v] as one sparse column block
// per free body, rows of six numbers, and the dense A_vv, from the rows of body_rows.h.

#include <Eigen/Dense>
#include <vector>

#include "coupling/step_problem.h"

namespace monolith {

template <class Real>
class BodyColumns {
 public:
  // In units of the twists divided by `scale`: columns and A_vv (without the bodies' inertia) are divided by it.
  void set(const StepProblem& problem, const Eigen::VectorXd& scale);
  template <class From>
  void convert(const BodyColumns<From>& from);

  // liquid += B v
  void addMotion(const Real* v, Real* liquid) const;
  // B^T liquid
  Eigen::VectorXd forces(const Real* liquid) const;
  const Eigen::MatrixXd& ownResistance() const { return A_vv_; }

 private:
  template <class>
  friend class BodyColumns;
  struct Entry {
    std::int32_t place;
    Real coefficient[6];
  };
  // Of the columns: faces of each axis, and cells. Different unknowns, so threads may take one each.
  static constexpr int kKinds = 4;

  std::size_t bodies() const { return begin_.size() / kKinds; }

  std::vector<Entry> entries_;      // by kinds, within them by bodies
  std::vector<std::size_t> begin_;  // of each kind and body; one more at the end
  Eigen::MatrixXd A_vv_;
};

}  // namespace monolith
