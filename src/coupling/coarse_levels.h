#pragma once
// Coefficients of the multigrid's levels below the finest, and how long they serve: they steer the solve and never
// decide its answer, so bodies may move a little before they are built anew.

#include <vector>

#include "rigid/rigid_body.h"
#include "solve/staggered_operator.h"

namespace monolith {

class CoarseLevels {
 public:
  // Whether the levels still serve: none of the bodies has moved far, and nothing else has changed.
  bool serve(const std::vector<RigidBody>& bodies, double viscous_number, double cell_width) const;
  // The levels have been built for these; `lasting`: they may serve again.
  void built(const std::vector<RigidBody>& bodies, double viscous_number, bool lasting);
  // They are changed by others.
  void change() {
    ++generation_;
    lasting_ = false;
  }
  void forget() { lasting_ = false; }
  // Whoever is to solve has made its own of these levels: of them only the lattices are kept.
  void release();

  // Changes with every build.
  long generation() const { return generation_; }

  // [0] is left empty; one at least once they are built.
  std::vector<StaggeredCoefficients<float>> levels;

 private:
  struct Pose {
    const SignedDistance* shape = nullptr;
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  };

  std::vector<Pose> poses_;
  double viscous_number_ = 0.0;
  bool lasting_ = false;
  long generation_ = 0;
};

}  // namespace monolith
