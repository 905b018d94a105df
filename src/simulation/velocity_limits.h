#pragma once
// Faces that hold little liquid have the velocity that lets all flow through them, however large: next to nothing moves
// with it. Carried on into faces that hold more, or into the air, it would be energy from nothing: water in which a
// cavity closes gained more than it fell by. What such a face passes on is therefore no more than what whole faces next
// to it tell.

#include <vector>

#include "coupling/solid_fractions.h"
#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

// Faces of which a solid leaves a small part: beyond the velocities next to it by no more than these and their
// differences.
void limitSlivers(const SolidFractions& solids, const MacGrid& grid, FaceField<double>& velocity, FaceMask& known);

// Faces that the surface cuts, of whose fluid part `liquid_mass` is less than all: no faster than whole faces about the
// two cells that they lie between are in any direction (by Bernoulli's law no more comes of what turns there), than two
// in a row tell when their velocity goes on straight, or than a point of the body that they are next to
// (body_speeds, m/s), and by `slack` (m/s) more. Those that are more than half full may be up to twice as fast.
void limitCutFaces(const FaceField<double>& liquid_mass, const SolidFractions& solids, const MacGrid& grid,
                   const std::vector<double>& body_speeds, double slack, FaceField<double>& velocity, FaceMask& known);

}  // namespace monolith
