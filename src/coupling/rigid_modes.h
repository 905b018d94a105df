#pragma once
// The motion of liquid and bodies together, as one rigid body, for the preconditioner of `fast`: liquid that no wall
// holds, and bodies in it, resist each other by the viscous number, their common motion by their mass alone. What one
// multigrid cycle leaves of the former is many times the latter, and the solve crawls (the first 10 steps of a falling
// blob around a box, viscous number 2500: 636 iterations each and many failures, 62 where it is added to the cycle, 37
// where it comes first).
//
// A coarse level of six unknowns for each region of liquid that is adrift:
//   z = R (R^T A R)^-1 R^T r,   R: rigid velocities of the region's faces and of the free bodies in it
// R^T A R is taken region by region; a body in two of them counts in both.

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

  // apply: y = A x over packed vectors (packed_system.h) of the liquid and the free bodies, whose unknowns are `scale`
  // times their twists. The problem must outlive the use.
  void set(const StepProblem& problem, const Eigen::VectorXd& scale, const Apply& apply);

  // z += R (R^T A R)^-1 R^T r, packed likewise; they may be longer.
  void correct(const std::vector<float>& r, std::vector<float>& z) const;

  int regions() const { return static_cast<int>(regions_.size()); }

 private:
  // Faces with an unknown next to each other along x; offsets from the region's centre, in its size.
  struct Run {
    std::ptrdiff_t begin, end;
    Eigen::Vector3d first;  // of the first face
  };
  struct Region {
    std::array<std::vector<Run>, 3> faces;
    std::vector<std::pair<Eigen::Index, Matrix6d>> bodies;  // first unknown; from amplitudes to unknowns
    double step = 0.0;                                      // between faces
    Matrix6d inverse = Matrix6d::Zero();                    // of R^T A R
  };
  using Amplitudes = Vector6d;  // velocity of the centre, then rotation

  // labels: of the cells of all regions that are adrift; this one's is `label`.
  Region makeRegion(const PressureRegion& liquid, int label, const std::vector<std::int32_t>& labels,
                    const Eigen::VectorXd& scale) const;
  // R^T r and z += R a, of one region.
  template <class Real>
  Amplitudes project(const Region& region, const std::vector<Real>& r) const;
  template <class Real>
  void add(const Region& region, const Amplitudes& a, std::vector<Real>& z) const;
  // R^T A R of these regions, which no body joins.
  // x, y: work space.
  void findEnergies(const std::vector<Region*>& regions, const Apply& apply, std::vector<double>& x,
                    std::vector<double>& y) const;

  const StepProblem* problem_ = nullptr;
  std::vector<Region> regions_;
};

}  // namespace monolith
