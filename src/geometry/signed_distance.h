#pragma once
// Signed distance of a solid: negative inside, positive outside, |gradient| = 1 almost everywhere.
// Units m; all points in the frame of the solid that owns the object.

#include <Eigen/Geometry>
#include <array>

namespace monolith {

struct DistanceSample {
  double distance;           // m, negative inside
  Eigen::Vector3d gradient;  // unit, points out of the solid
};

// Faces by which a solid can be left from a point in it or next to it: the plane of each, by the distance to it. Every
// point beyond one of them is out of the solid, as long as the solid is convex.
struct SolidFaces {
  std::array<DistanceSample, 7> face;
  int count = 0;

  void append(double distance, const Eigen::Vector3d& gradient) { face[count++] = {distance, gradient}; }
};

class SignedDistance {
 public:
  virtual ~SignedDistance() = default;
  virtual DistanceSample sample(const Eigen::Vector3d& point) const = 0;
  virtual double distance(const Eigen::Vector3d& point) const { return sample(point).distance; }
  // The nearest face and others no deeper than `reach`, if the solid has any.
  virtual void appendFaces(const Eigen::Vector3d& point, double /*reach*/, SolidFaces& faces) const {
    const DistanceSample nearest = sample(point);
    faces.append(nearest.distance, nearest.gradient);
  }
  // Axis-aligned box that holds the whole solid.
  virtual Eigen::AlignedBox3d bounds() const = 0;
};

}  // namespace monolith
