#pragma once
// What is common to all who read or make the level set of the liquid's surface.

namespace monolith {

// Half-width, in cells, of the band around the surface in which the level set is a distance; beyond it is just as large
// as that, which is further than anyone looks.
constexpr double kLevelSetBand = 6.0;
constexpr double kLevelSetFar = 1e3;  // cell widths: not known yet, or no liquid

}  // namespace monolith
