#pragma once
// No slip where viscosity resolves it: the liquid next to a solid that moves with the solid.
//
// Between a face in the liquid and a surface at the part theta of the segment to its solid neighbour the velocity is
// linear, so half of that layer's momentum and flux belong to the surface, half to the face. The share
// (theta_- + theta_+)/2 of the face's control volume (the least over the axes), and a little more where a surface cuts,
// stays the face's; the rest, and all liquid of faces whose centre is solid, sticks: it moves as the solid does at the
// face, with its mass, weight and flux. W_F + sum_i W_Si + W_wall stays 1, momentum and buoyancy stay exact. Measured
// on periodic arrays of spheres (c 0.008 to 0.128, four positions): drag within 0.45 % at D/h = 10, and -0.8 to 0.2 %
// in the mean over the positions at 6 and 4; with no sticking liquid -0.5 % at 10 and -1.7 to -5.7 % at 4. The error of
// a plane channel's flow rate is halved.

#include <vector>

#include "coupling/solid_fractions.h"

namespace monolith {

// Pa.s: a liquid that is less viscous slips past solids within the cell next to them, and viscosity only drags it
// along. In the time in which something that is as fast as `speed` (m/s) moves by a cell, the layer at a solid must
// grow through a good part of it: mu >= 0.1 rho U h. No time step is in it, or results would jump where the step is
// refined.
double stickingViscosity(double density, double speed, double cell_width);

// Moves the sticking part of `fluid` to the bodies' fractions (to nothing at walls). Returns the inertia M^ of the
// liquid that each body has got, which moves as its points do; liquid_distance in cell widths with its halo filled.
std::vector<Matrix6d> attachStickingLiquid(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                           const std::vector<double>& liquid_distance, SolidFractions& solids);

// The same of liquid that slips, at walls thinner than two cells alone: faces whose centre lies in such a wall may be
// open on both sides of it and would let the liquid through.
std::vector<Matrix6d> closeThinWalls(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                     const std::vector<double>& liquid_distance, SolidFractions& solids);

}  // namespace monolith
