#pragma once
// The motion of liquid and bodies together, as one rigid body, for the preconditioner of `fast`: liquid that no wall
// holds, and bodies in it, resist each other by the viscous number, their common motion by their mass alone. What one
// multigrid cycle leaves of the former is many times the latter, and the solve crawls (`./tank cases hard`, a blob of
// 1e5 Pa.s around a box and two of 1e4: 18 and 40 iterations a step without this, 9 and 21 with it).
//
// A coarse level of six unknowns for all that drifts together (pressure_regions.h):
//   z = R (R^T A R)^-1 R^T r,   R: rigid velocities of the faces of its liquid and of the free bodies in that
// No body is in two, so R^T A R is a block for each.

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "coupling/step_problem.h"

namespace monolith {

class RigidModes {
 public:
  using Apply = std::function<void(std::vector<double>& x, std::vector<double>& y)>;

  // apply: y = A x over packed vectors (packed_system.h) of the liquid and the bodies, whose unknowns are `scale` times
  // those of their motion. The problem must outlive the use.
  void set(const StepProblem& problem, const Eigen::VectorXd& scale, const Apply& apply);

  // z += R (R^T A R)^-1 R^T r, packed likewise; they may be longer.
  void correct(const std::vector<float>& r, std::vector<float>& z) const;

  int drifts() const { return static_cast<int>(drifts_.size()); }

 private:
  // Faces with an unknown next to each other along x; offsets from the drift's centre, in its size.
  struct Run {
    std::ptrdiff_t begin, end;
    Eigen::Vector3d first;  // of the first face
  };
  struct Drift {
    std::array<std::vector<Run>, 3> faces;
    // First unknown; from amplitudes to unknowns.
    std::vector<std::pair<Eigen::Index, Eigen::Matrix<double, Eigen::Dynamic, 6>>> bodies;
    double step = 0.0;                                      // between faces
    Matrix6d inverse = Matrix6d::Zero();                    // of R^T A R
  };
  using Amplitudes = Vector6d;  // velocity of the centre, then rotation

  // numbers: of the drifts, at their cells.
  Drift makeDrift(int number, const std::vector<std::int32_t>& numbers, const Eigen::VectorXd& scale) const;
  // R^T r and z += R a, of one drift.
  template <class Real>
  Amplitudes project(const Drift& drift, const std::vector<Real>& r) const;
  template <class Real>
  void add(const Drift& drift, const Amplitudes& a, std::vector<Real>& z) const;
  void findEnergies(const Apply& apply, std::size_t size);

  const StepProblem* problem_ = nullptr;
  std::vector<Drift> drifts_;
};

}  // namespace monolith
