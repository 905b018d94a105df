#pragma once
// The liquid's motion beyond the faces whose velocity the solve tells: in the bodies, and in the air, where the surface
// and what the liquid is transported by look for it.
//
// In air next to the surface the vorticity of the liquid goes on as it is there:
//   u_a(f) = u_a(g) + du_b + (u_a(g) - u_a(g') - du_b'),   f, g, g' in a row along b,
// du_b the difference along a of u_b at the edge between f and g, du_b' between g and g'. Of a flow without vorticity
// that is exact to second order, and faces that become liquid begin with the velocity that the flow there has; a
// velocity that goes on by its own slope alone is too small over crests, too large in troughs, and waves shrink or grow
// by it, within tens of periods by times three (`./tank validate ripples`).
//
// In a body it is the body's motion where liquid sticks to it. Where it slips (coupling/sticking_liquid.h), however
// little viscous, it is the mean of the faces around, layer by layer inwards: what a trajectory next to a body ends at
// is interpolated from faces in the body, too, and with the body's motion there the liquid beside it would be dragged
// along at every step while nothing held the body back. Momentum would come of nothing, and a light ball that bobs
// would go off to the side. Walls less than three cells thick keep the body's motion all the same: they have to keep
// what moves on their two sides apart.

#include <vector>

#include "coupling/solid_fractions.h"
#include "fluid/mac_grid.h"
#include "rigid/rigid_body.h"
#include "solve/staggered_operator.h"

namespace monolith {

// A velocity of the liquid, or its rate, and the bodies' twists, or their rates.
struct LiquidField {
  FaceField<double>* values;
  const std::vector<Vector6d>* of_bodies;
  double steepest;  // of the slope with which it goes on into the air, per cell
};

// Gives faces inside bodies the bodies' motion if the liquid `sticks` to them, and spreads what is known into solids
// and air, marking it known. no_slip: beyond the tank's walls, as extrapolateVelocity(). work: a mask that may be
// written to.
void completeMotion(const SolidFractions& solids, const MacGrid& grid, const std::vector<RigidBody>& bodies, int layers,
                    bool sticks, bool no_slip, const std::vector<LiquidField>& fields, FaceMask& known, FaceMask& work);

}  // namespace monolith
