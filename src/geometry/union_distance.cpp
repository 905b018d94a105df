#include "geometry/union_distance.h"

#include <algorithm>
#include <array>
#include <optional>

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kReach = 5.0;         // resolutions, each half a cell: nobody asks how far below the surface more is
constexpr double kGap = 1e-3;          // resolutions between parts that touch ...
constexpr double kRelativeGap = 1e-6;  // ... or of the body's size: what is left of it by the decimals of a URDF
constexpr int kMostCorrections = 3;    // of a foot
constexpr int kMostPartsLeft = 8;      // on the way out
constexpr double kLeastSine = 1e-6;    // of the angle between planes that have a line in common

struct HalfSpace {
  Vector3d normal;
  double least;  // of normal . step
};

// The shortest step that leads into the half-spaces of the faces one has left by; those alone that bound it.
struct WayOut {
  Vector3d step = Vector3d::Zero();
  std::array<HalfSpace, 3> planes;
  int count = 0;

  // Onto the plane, and along the ones before; false where it is parallel to them. `basis`: spans their normals.
  bool append(const HalfSpace& plane, std::array<Vector3d, 3>& basis) {
    Vector3d across = plane.normal;
    for (int i = 0; i < count; ++i) across -= basis[i].dot(plane.normal) * basis[i];
    const double sine = across.norm();
    if (sine < kLeastSine) return false;
    basis[count] = across / sine;
    step += (plane.least - plane.normal.dot(step)) / sine * basis[count];
    planes[count++] = plane;
    return true;
  }
};

// Into one more half-space, which the way so far does not lead into: its plane bounds the step, and of the others the
// ones by which it gets shortest.
std::optional<WayOut> extended(const WayOut& before, const HalfSpace& added, double slack) {
  std::optional<WayOut> best;
  for (int kept = 0; kept < (1 << before.count); ++kept) {
    if (kept == 7) continue;  // four planes have no point in common
    WayOut way;
    std::array<Vector3d, 3> basis;
    bool possible = way.append(added, basis);
    for (int i = 0; i < before.count && possible; ++i) {
      if ((kept >> i) & 1) possible = way.append(before.planes[i], basis);
    }
    for (int i = 0; i < before.count && possible; ++i) {
      possible = before.planes[i].normal.dot(way.step) >= before.planes[i].least - slack;
    }
    if (possible && (!best || way.step.squaredNorm() < best->step.squaredNorm())) best = way;
  }
  return best;
}

class UnionDistance : public SignedDistance {
 public:
  UnionDistance(std::vector<PlacedSolid> parts, double resolution) : parts_(std::move(parts)) {
    for (const PlacedSolid& part : parts_) bounds_.extend(part.bounds_B);
    reach_ = kReach * resolution;
    gap_ = std::max(kGap * resolution, kRelativeGap * bounds_.diagonal().norm());
  }

  DistanceSample sample(const Vector3d& point) const override {
    double distance = 0.0;
    const std::size_t nearest = nearestPart(point, distance);
    return mayHaveSeam(point, nearest, distance) ? sampleInside(point, nearest) : sampleOf(parts_[nearest], point);
  }

  double distance(const Vector3d& point) const override {
    double distance = 0.0;
    const std::size_t nearest = nearestPart(point, distance);
    return mayHaveSeam(point, nearest, distance) ? sampleInside(point, nearest).distance : distance;
  }

  AlignedBox3d bounds() const override { return bounds_; }

 private:
  // No field is below the distance to the box around its solid.
  static bool cannotBeNearer(const PlacedSolid& part, const Vector3d& point, double distance) {
    return distance > 0.0 ? part.bounds_B.squaredExteriorDistance(point) > distance * distance
                          : !part.bounds_B.contains(point);
  }

  static double distanceOf(const PlacedSolid& part, const Vector3d& point) {
    return part.field->distance(part.X_GB * point);
  }

  static DistanceSample sampleOf(const PlacedSolid& part, const Vector3d& point) {
    DistanceSample sample = part.field->sample(part.X_GB * point);
    sample.gradient = part.X_GB.linear().transpose() * sample.gradient;
    return sample;
  }

  std::size_t nearestPart(const Vector3d& point, double& distance) const {
    std::size_t nearest = 0;
    distance = distanceOf(parts_.front(), point);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      if (cannotBeNearer(parts_[i], point, distance)) continue;
      const double candidate = distanceOf(parts_[i], point);
      if (candidate < distance) {
        distance = candidate;
        nearest = i;
      }
    }
    return nearest;
  }

  // A part that a point lies in, or so near to that nothing is between; but for one of them.
  const PlacedSolid* partAt(const Vector3d& point, const PlacedSolid* but = nullptr) const {
    for (const PlacedSolid& part : parts_) {
      if (&part == but || part.bounds_B.squaredExteriorDistance(point) > gap_ * gap_) continue;
      if (distanceOf(part, point) <= gap_) return &part;
    }
    return nullptr;
  }

  // One looks for the way out from beyond the gap that counts as none.
  double clearance() const { return 2.0 * gap_; }

  // Whether the nearest face, at `distance`, may be one in common with another part.
  bool mayHaveSeam(const Vector3d& point, std::size_t nearest, double distance) const {
    if (distance > gap_ || distance < -reach_) return false;
    const double reach = 2.0 * clearance() - distance;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (i != nearest && parts_[i].bounds_B.squaredExteriorDistance(point) <= reach * reach) return true;
    }
    return false;
  }

  // Just beyond the nearest face of a part.
  Vector3d beyondFoot(const PlacedSolid& part, const Vector3d& point, const DistanceSample& sample) const {
    Vector3d beyond = point + (clearance() - sample.distance) * sample.gradient;
    // Baked distances are not exact.
    for (int i = 0; i < kMostCorrections && distanceOf(part, beyond) <= gap_; ++i) {
      const DistanceSample again = sampleOf(part, beyond);
      beyond += (clearance() - again.distance) * again.gradient;
    }
    return beyond;
  }

  // The sample of the nearest part holds for the whole unless another part lies beyond the foot of the point.
  DistanceSample sampleInside(const Vector3d& point, std::size_t nearest) const {
    const PlacedSolid& part = parts_[nearest];
    const DistanceSample sample = sampleOf(part, point);
    if (!partAt(beyondFoot(part, point, sample), &part)) return sample;
    Vector3d shortest = Vector3d::Zero();
    double length = reach_ + clearance();
    leave(part, point, WayOut(), 1, shortest, length);
    // None within reach: deep inside.
    const Vector3d gradient = shortest.isZero(0.0) ? sample.gradient : Vector3d(shortest / length);
    return {std::min(sample.distance, clearance() - length), gradient};
  }

  // Branch and bound: whoever is to come out of the whole has to leave the part he is in by one of its faces; if that
  // leads into another part, it is to be left as well. Exact where faces are plane, and the way goes to an edge or a
  // corner where it is shortest so. `shortest` and its length: the best so far.
  void leave(const PlacedSolid& part, const Vector3d& point, const WayOut& way, int parts_left, Vector3d& shortest,
             double& length) const {
    SolidFaces faces;
    const Vector3d at = point + way.step;
    part.field->appendFaces(part.X_GB * at, reach_, faces);
    for (int f = 0; f < faces.count; ++f) {
      const DistanceSample& face = faces.face[f];
      const Vector3d normal = part.X_GB.linear().transpose() * face.gradient;
      const double least = normal.dot(way.step) + clearance() - face.distance;
      if (least >= length) continue;
      const std::optional<WayOut> next = extended(way, {normal, least}, 1e-3 * gap_);
      if (!next || next->step.squaredNorm() >= length * length) continue;
      const PlacedSolid* in = partAt(point + next->step);
      if (!in) {
        shortest = next->step;
        length = shortest.norm();
      } else if (parts_left < kMostPartsLeft) {
        leave(*in, point, *next, parts_left + 1, shortest, length);
      }
    }
  }

  std::vector<PlacedSolid> parts_;
  AlignedBox3d bounds_;
  double reach_;  // m
  double gap_;    // m
};

}  // namespace

std::shared_ptr<const SignedDistance> makeUnionDistance(std::vector<PlacedSolid> parts, double resolution) {
  return std::make_shared<UnionDistance>(std::move(parts), resolution);
}

}  // namespace monolith
