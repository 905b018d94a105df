#include "coupling/coarse_levels.h"

namespace monolith {
namespace {

constexpr double kSmallMove = 0.5;  // of a cell of the finest level

}  // namespace

bool CoarseLevels::serve(const std::vector<RigidBody>& bodies, double viscous_number, double cell_width) const {
  if (!lasting_ || viscous_number != viscous_number_ || bodies.size() != poses_.size()) return false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].distance.get() != poses_[b].shape) return false;
    if (!(bodies[b].distanceFrom(poses_[b].X_WB) <= kSmallMove * cell_width)) return false;
  }
  return true;
}

void CoarseLevels::built(const std::vector<RigidBody>& bodies, double viscous_number, bool lasting) {
  ++generation_;
  lasting_ = lasting;
  viscous_number_ = viscous_number;
  poses_.clear();
  for (const RigidBody& body : bodies) poses_.push_back({body.distance.get(), body.pose()});
}

void CoarseLevels::release() {
  for (auto& level : levels) {
    const Lattice lattice = level.lattice;
    level = StaggeredCoefficients<float>();
    level.lattice = lattice;
  }
}

}  // namespace monolith
