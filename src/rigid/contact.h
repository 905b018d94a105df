#pragma once
// Contact detection: pairs of points where bodies touch or may touch within a step, each a row of the
// normal contact Jacobian J_n. Broad phase by FCL; sign and manifold by convex shapes and the distance fields.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "rigid/rigid_body.h"

namespace monolith {

// Row c of J_n: gap rate = (v_a(point) - v_b(pointOnB())) . normal. The normal points from b towards a.
// body_b = kWall: the tank's wall, at rest.
struct Contact {
  static constexpr int kWall = -1;
  int body_a = 0;
  int body_b = kWall;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // m, in W, at body_a
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double gap = 0.0;                                  // m, negative when they penetrate
  // As the bodies move the point goes along with body_a by this share, for the rest with body_b: with a corner, not
  // with the face it is on; with a ball that rolls. Negative: not known.
  double share_a = -1.0;
  // Whole periods from body_b to that of its periodic images which body_a touches.
  Eigen::Vector3d shift_b = Eigen::Vector3d::Zero();  // m

  // The same point at body_b.
  Eigen::Vector3d pointOnB() const { return point - shift_b; }

  // The bodies in the other order.
  void turn() {
    point = pointOnB();
    shift_b = -shift_b;
    normal = -normal;
    if (share_a >= 0.0) share_a = 1.0 - share_a;
  }
};

// The tank's inside, and which of its axes have no walls.
struct TankWalls {
  Eigen::AlignedBox3d inside;
  bool periodic[3] = {false, false, false};

  // m, after which images repeat; 0 along an axis with walls.
  Eigen::Vector3d period() const {
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) out[a] = periodic[a] ? inside.sizes()[a] : 0.0;
    return out;
  }

  // That of the periodic images of x which lies inside.
  Eigen::Vector3d imageInside(const Eigen::Vector3d& x) const {
    Eigen::Vector3d image = x;
    for (int a = 0; a < 3; ++a) {
      const double period = inside.sizes()[a];
      if (periodic[a]) image[a] -= period * std::floor((x[a] - inside.min()[a]) / period);
    }
    return image;
  }

  // f(shift, periods): for every shift by whole periods, but for none at all, with which box b meets box a; both of
  // bodies whose centres are in the tank.
  template <class Function>
  void forEachImage(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, Function&& f) const {
    constexpr double kMost = 8.0;  // what reaches over more periods is endless
    const Eigen::Vector3d period = inside.sizes();
    std::array<int, 3> first{}, last{}, at{};
    for (int axis = 0; axis < 3; ++axis) {
      if (periodic[axis]) {
        first[axis] = static_cast<int>(std::max(-kMost, std::ceil((a.min()[axis] - b.max()[axis]) / period[axis])));
        last[axis] = static_cast<int>(std::min(kMost, std::floor((a.max()[axis] - b.min()[axis]) / period[axis])));
      } else if (!(a.min()[axis] <= b.max()[axis] && b.min()[axis] <= a.max()[axis])) {
        return;
      }
    }
    for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) {
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1]) {
        for (at[2] = first[2]; at[2] <= last[2]; ++at[2]) {
          const Eigen::Vector3d periods(at[0], at[1], at[2]);
          if (!periods.isZero(0.0)) f(Eigen::Vector3d(periods.cwiseProduct(period)), at);
        }
      }
    }
  }
};

class ContactDetector {
 public:
  ContactDetector(const std::vector<RigidBody>& bodies, const TankWalls& walls);
  ~ContactDetector();

  // All contacts with gap <= margin (m), in a fixed order: pairs of bodies with body_a < body_b, then walls by body.
  // A pair of bodies that are both fixed or prescribed gives none, nor does such a body with a wall. Points of a pair
  // of bodies are half-way between the surfaces, with a wall on the body. Along periodic axes bodies touch in all their
  // images, but none its own.
  // Throws std::invalid_argument if the number of bodies is not that of the constructor.
  std::vector<Contact> detect(const std::vector<RigidBody>& bodies, double margin);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace monolith
