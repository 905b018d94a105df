#pragma once
// Pressure where solids meet. A body that lies flush on the floor or on another body has cells in the contact that no
// liquid is in, so no pressure either; without one a body would be held down by all that is above it, and a box on the
// bottom of a full tank could never be lifted. Real surfaces let liquid in: the contact is as wet as its rim. The
// body's rows of J_p in such a cell c therefore act on the nearest cells q with pressure, reached along the contact,
// with the weight of the liquid between (in the mean, where several are as near),
//   p_c = p_q + rho g . (x_c - x_q),
// and what the body's motion opens there is filled from q. Next to a wall the pressure's last sample is half a cell
// away; the same weight of liquid makes up for the rest. Buoyancy of a resting body is that of Archimedes.

#include <Eigen/Dense>
#include <vector>

#include "coupling/body_rows.h"
#include "coupling/solid_fractions.h"

namespace monolith {

// The constant part of a pressure: an impulse coefficient * (dt/h g . offset) on the body.
struct EnclosedWeight {
  int body = 0;
  Vector6d coefficient = Vector6d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // x_c - x_q, m
};

// Moves rows.enclosed of cells below the liquid's surface to rows.divergence; the others meet no liquid and are
// dropped.
std::vector<EnclosedWeight> moveEnclosedRows(const MacGrid& grid, const SolidFractions& solids,
                                             const std::vector<RigidBody>& bodies,
                                             const StaggeredCoefficients<double>& coefficients,
                                             const std::vector<double>& liquid_distance, BodyRows& rows);

}  // namespace monolith
