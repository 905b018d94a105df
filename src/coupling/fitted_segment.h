#pragma once
// One velocity difference of the fitted gradient (stokes_coefficients.h): along the segment from face A to face B of
// one velocity component.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/cube_fraction.h"

namespace monolith {

constexpr double kLeastTheta = 0.05;
constexpr double kMostSag = 0.125;  // cell widths

enum class FaceKind : std::uint8_t {
  kFluid,   // centre in the liquid: an unknown
  kSliver,  // centre in a solid, control volume partly open: an unknown that viscosity ties to the solid
  kSolid,   // in a body or the wall: moves with it
  kAir,     // no liquid: no velocity
};

inline bool isSolid(FaceKind kind) { return kind == FaceKind::kSliver || kind == FaceKind::kSolid; }

struct FittedSegment {
  bool defined = false;  // neither end in the air
  bool both_solid = false;
  bool cut = false;    // by the surface of a solid
  double theta = 1.0;  // part of the segment that lies in the liquid
};

// Where in (0, 1) the parabola is zero that is `fluid` > 0 at 0, `solid` < 0 at 1 and lies `sag` below their mean in
// the middle. The distance of a convex solid sags: a straight line between its ends would find the surface too deep, by
// up to h^2/8 times the curvature, and the solid too small.
inline double surfaceCrossing(double fluid, double solid, double sag) {
  const double b = fluid - solid + 4.0 * sag;
  return 2.0 * fluid / (b + std::sqrt(b * b - 16.0 * sag * fluid));
}

// sag: by how much the distance half way lies below the mean of the ends'.
inline FittedSegment fitSegment(FaceKind kind_a, double distance_a, FaceKind kind_b, double distance_b, double sag) {
  FittedSegment s;
  s.defined = kind_a != FaceKind::kAir && kind_b != FaceKind::kAir;
  const bool solid_a = isSolid(kind_a);
  const bool solid_b = isSolid(kind_b);
  s.both_solid = solid_a && solid_b;
  s.cut = solid_a != solid_b;
  if (solid_a != solid_b) {
    const double fluid = std::max(solid_a ? distance_b : distance_a, 0.0);
    const double solid = std::min(solid_a ? distance_a : distance_b, 0.0);
    if (!(fluid > 0.0)) {
      s.theta = kLeastTheta;
    } else if (solid < 0.0) {
      // Between two solids the distance has a kink, not a curvature: as much as a sphere of one cell's radius has, at
      // most.
      const double least = -0.125 * (fluid - solid);
      s.theta = std::clamp(surfaceCrossing(fluid, solid, std::clamp(sag, least, kMostSag)), kLeastTheta, 1.0);
    }
  }
  return s;
}

// Energy weight of a shear sample: the liquid part of its control volume under the plane that the distances at its four
// faces span, 1 where the surface cuts neither segment.
inline double shearWeight(const FittedSegment& s, const FittedSegment& t, double s_low, double s_high, double t_low,
                          double t_high) {
  if (s.both_solid && t.both_solid) return 0.0;
  if (!s.cut && !t.cut) return 1.0;
  const Eigen::Vector3d slope(s_high - s_low, t_high - t_low, 0.0);
  const double distance = 0.25 * (s_low + s_high + t_low + t_high);
  const double steepness = slope.norm();
  if (!(steepness > 0.0)) return kLeastTheta;
  return std::max(1.0 - insideFraction(distance / steepness, slope, 1.0), kLeastTheta);
}

}  // namespace monolith
