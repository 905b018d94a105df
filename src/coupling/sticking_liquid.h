#pragma once
// No slip where viscosity resolves it: the liquid next to a body that moves with the body.
//
// Between a face in the liquid and a surface at the part theta of the segment to its solid neighbour the velocity is linear, so
// half of that layer's momentum and flux belong to the surface, half to the face. The share (theta_- + theta_+)/2 of the
// face's control volume (the least over the axes) stays the face's; the rest, and all liquid of faces whose centre is
// solid, sticks: it moves as the body does at the face, with its mass, weight and flux. W_F + sum_i W_Si stays 1, momentum
// and buoyancy stay exact. Measured on the periodic array of spheres (phi 0.027 to 0.125, four positions, mean): drag
// -2.6 to -4.0 % at D/h = 3.7 and below 0.1 % at 10; without it, -5 to -10 % and -0.5 to -1 %.

#include <vector>

#include "coupling/solid_fractions.h"

namespace monolith {

struct StickingLiquid {
  int axis = 0;
  std::ptrdiff_t face = 0;
  int body = 0;
  double fraction = 0.0;  // of the control volume, liquid or air
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the face, in the image next to the body
};

// Moves the sticking part of `fluid` to the bodies' fractions (to nothing at walls) and lists it.
void attachStickingLiquid(const MacGrid& grid, SolidFractions& solids, std::vector<StickingLiquid>& out);

}  // namespace monolith
