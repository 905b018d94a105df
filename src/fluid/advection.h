#pragma once
// Transport by the liquid's own velocity: semi-Lagrangian (Robert 1981), traced back by the midpoint rule, tricubic
// at the foot. Stable at any CFL number.

#include <array>
#include <cstdint>

#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

// Spreads velocities, or their rates, from faces where known[a] is set to those within `layers` of them (mean of the
// known neighbours), marking these known, and into the halo: odd across a wall for the normal component and, with no
// slip, for the tangential ones; even otherwise.
void extrapolateVelocity(const Lattice& lattice, int layers, bool no_slip, FaceMask& known,
                         const std::vector<FaceField<double>*>& fields);

// The velocity at the foot of the trajectory that arrives at a face; scale: dt/h. Halos must be filled.
double advectFace(const Lattice& lattice, const FaceField<double>& velocity, int axis, const std::array<int, 3>& face,
                  double scale);

// Likewise a cell-centred field at a cell.
double advectCell(const Lattice& lattice, const FaceField<double>& velocity, const std::vector<double>& field,
                  const std::array<int, 3>& cell, double scale);

// The velocity field moved by itself over dt, on faces of the tank that are known, those in walls excepted; zero
// elsewhere. Halos must be filled.
void advectVelocity(const MacGrid& grid, const FaceField<double>& velocity, const FaceMask& known, double dt,
                    FaceField<double>& moved);

// The same with trajectories of second order in time: with the acceleration a of the liquid's particles they are
// x = x_d + dt u(x_d) + dt^2/2 a(x_d). moved: u(x_d); gained: a(x_d), trilinear; mean: work space.
void advectAccelerated(const MacGrid& grid, const FaceField<double>& velocity, const FaceField<double>& acceleration,
                       const FaceMask& known, double dt, FaceField<double>& moved, FaceField<double>& gained,
                       FaceField<double>& mean);

// A cell-centred field moved by the velocity over dt, where its size is less than `band`; elsewhere it stays. Halos
// must be filled.
void advectCells(const MacGrid& grid, const FaceField<double>& velocity, const std::vector<double>& field, double dt,
                 double band, std::vector<double>& moved);

// Velocity at a point, position in cell widths from the tank's corner.
Eigen::Vector3d velocityAt(const Lattice& lattice, const FaceField<double>& velocity, const Eigen::Vector3d& position);

}  // namespace monolith
