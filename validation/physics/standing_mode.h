#pragma once
// The slowest standing wave of small height in a rectangular tank of viscous liquid, two-dimensional: the eigenvalue of
// the Stokes equations on the undisturbed domain with a linearised surface,
//
//   rate u = -grad p + nu laplace u,  div u = 0,  rate eta = w and p - 2 nu w_z = g eta, u_z + w_x = 0 at the surface,
//
// u = 0 on the floor and the side walls. What boundary-layer theory leaves out, the corners in which the surface slides
// along the walls, is in it: in a tank of 1 m and half as deep the damping is larger by 29 % at 1e-3 m^2/s and by 18 %
// at 1e-4; without friction at the side walls the two agree (test/validation/standing_mode_test.cpp). Finite volumes on
// a staggered grid that gets finer towards walls and surface, to 1/2000 of the length.

#include <complex>

namespace monolith {

struct StandingTank {
  double length = 1.0;     // m
  double depth = 0.5;      // m
  double gravity = 9.81;   // m/s^2
  double viscosity = 0.0;  // m^2/s, more than 0
  bool walls_hold = true;  // no slip at the side walls
};

// Linear waves without viscosity, rad/s.
double inviscidFrequency(const StandingTank& tank);
// rate = -damping + i frequency, 1/s, as boundary-layer theory has it.
std::complex<double> boundaryLayerRate(const StandingTank& tank);
// The same of the equations above. Throws std::runtime_error if it is not found.
std::complex<double> standingRate(const StandingTank& tank);

}  // namespace monolith
