#pragma once
// Contact points of two convex shapes. The direction n comes from rigid/convex_separation.h. Where a flat face
// of one shape is square to n (within 10 degrees) that face is the reference: the other shape's nearest piece
// is clipped to the prism above it, and every corner left is a contact with the face's normal and the corner's
// height as its gap. That gives a resting body its whole support polygon, edge crossings included. Parallel
// lines give two points, all else the one closest pair.

#include "rigid/contact.h"
#include "rigid/convex_shape.h"

namespace monolith {

constexpr int kMostPointsPerConvexPair = 8;

// Appends the contacts with gap <= margin, bodies unset. Points are half-way between the surfaces.
void appendConvexContacts(const ConvexShape& a, const ConvexShape& b, double margin,
                          std::vector<Contact>& contacts);

}  // namespace monolith
