#pragma once
// Sampling of staggered fields between their nodes. Positions in cell widths from the tank's corner.

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "solve/lattice.h"

namespace monolith {

// Where the node called (0, 0, 0) lies: cell centres at (1/2, 1/2, 1/2), faces of axis a half a cell lower along a.
inline Eigen::Vector3d nodeOffset(int face_axis) {
  Eigen::Vector3d offset(0.5, 0.5, 0.5);
  if (face_axis >= 0) offset[face_axis] = 0.0;
  return offset;
}

// Part of its stencil's range by which a cubic overshoots at a smooth, resolved extremum (1/8), and a little more.
constexpr double kOvershoot = 0.15;

// Trilinear; positions are clamped to the tank along axes with walls, wrapped along periodic ones.
double sampleLinear(const Lattice& lattice, const std::vector<double>& field, const Eigen::Vector3d& node_position);

// All three components of a face-normal velocity at a point; `position` from the tank's corner. Trilinear.
Eigen::Vector3d sampleVelocity(const Lattice& lattice, const std::array<std::vector<double>, 3>& velocity,
                               const Eigen::Vector3d& position);

// Tricubic (Lagrange, fourth order). `limited`: kept within
// the range of its stencil but for the overshoot of a smooth extremum, so that jumps do not ring.
double sampleCubic(const Lattice& lattice, const std::vector<double>& field, const Eigen::Vector3d& node_position,
                   bool limited);

}  // namespace monolith
