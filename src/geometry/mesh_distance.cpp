// The only file that includes OpenVDB: it takes long to compile.
#include "geometry/mesh_distance.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/mesh.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kPadding = 4.0;           // resolutions outside the bounding box of the mesh
constexpr double kLeastCellsAcross = 8.0;  // of a mesh's thinnest extent ...
constexpr double kMostSamples = 2e6;       // ... unless that costs more memory than this
constexpr double kSamplesAtAll = 1e8;      // nor the wanted resolution more than this
constexpr double kLeastStride = 0.25;      // spacings, along a ray

class GridDistance : public SignedDistance {
 public:
  GridDistance(const AlignedBox3d& bounds, const Vector3d& origin, double spacing, const Vector3i& samples,
               std::vector<float> values)
      : bounds_(bounds),
        grid_(origin, origin + spacing * (samples.array() - 1).cast<double>().matrix()),
        spacing_(spacing),
        samples_(samples),
        values_(std::move(values)) {}

  DistanceSample sample(const Vector3d& point) const override {
    const Vector3d nearest = clamp(point, grid_);
    const Vector3d offset = point - nearest;
    Vector3d gradient;
    const double value = interpolate(nearest, &gradient);
    const double baked = extend(value, offset);
    const double box_distance = bounds_.exteriorDistance(point);
    if (box_distance > 0.0 && box_distance > baked) {
      return {box_distance, (point - clamp(point, bounds_)) / box_distance};
    }
    // Along an axis on which the point was clamped the interpolant is constant.
    for (int axis = 0; axis < 3; ++axis) {
      if (offset[axis] != 0.0) gradient[axis] = offset[axis] / value;
    }
    return {baked, direction(gradient, point)};
  }

  double distance(const Vector3d& point) const override {
    const Vector3d nearest = clamp(point, grid_);
    const double baked = extend(interpolate(nearest, nullptr), point - nearest);
    const double box_distance = bounds_.exteriorDistance(point);
    return box_distance > 0.0 ? std::max(box_distance, baked) : baked;
  }

  // A mesh tells no faces but the nearest: the others are looked for along the axes.
  void appendFaces(const Vector3d& point, double reach, SolidFaces& faces) const override {
    SignedDistance::appendFaces(point, reach, faces);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vector3d direction = side * Vector3d::Unit(axis);
        double way = 0.0, inside = distance(point);
        while (inside <= 0.0 && way < reach) {
          way += std::max(-inside, kLeastStride * spacing_);
          inside = distance(point + way * direction);
        }
        if (inside <= 0.0) continue;
        const DistanceSample exit = sample(point + way * direction);
        faces.append(exit.distance - way * exit.gradient.dot(direction), exit.gradient);
      }
    }
  }

  AlignedBox3d bounds() const override { return bounds_; }

 private:
  static Vector3d clamp(const Vector3d& point, const AlignedBox3d& box) {
    return point.cwiseMax(box.min()).cwiseMin(box.max());
  }

  // Distance at a point `offset` outside the grid from the value at the nearest point of the grid. The grid is
  // convex and holds the mesh: no surface point can be nearer than this.
  static double extend(double value, const Vector3d& offset) {
    const double squared_offset = offset.squaredNorm();
    return squared_offset > 0.0 ? std::sqrt(squared_offset + value * value) : value;
  }

  // Where the field is flat (medial surface, end of the band) away from the middle is as good as any.
  Vector3d direction(const Vector3d& gradient, const Vector3d& point) const {
    const double norm = gradient.norm();
    if (norm > 1e-3) return gradient / norm;
    const Vector3d from_centre = point - bounds_.center();
    const double length = from_centre.norm();
    return length > 0.0 ? Vector3d(from_centre / length) : Vector3d::UnitX();
  }

  double interpolate(const Vector3d& point, Vector3d* gradient) const {
    int base[3];
    double t[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double position = (point[axis] - grid_.min()[axis]) / spacing_;
      base[axis] = std::min(std::max(static_cast<int>(position), 0), samples_[axis] - 2);
      t[axis] = position - base[axis];
    }
    const std::size_t row = samples_.x();
    const std::size_t plane = row * samples_.y();
    const float* v = &values_[base[0] + row * base[1] + plane * base[2]];
    const double dx00 = v[1] - v[0], dx10 = v[row + 1] - v[row];
    const double dx01 = v[plane + 1] - v[plane], dx11 = v[plane + row + 1] - v[plane + row];
    const double x00 = v[0] + t[0] * dx00, x10 = v[row] + t[0] * dx10;
    const double x01 = v[plane] + t[0] * dx01, x11 = v[plane + row] + t[0] * dx11;
    const double y0 = x00 + t[1] * (x10 - x00), y1 = x01 + t[1] * (x11 - x01);
    if (gradient) {
      const double dx0 = dx00 + t[1] * (dx10 - dx00), dx1 = dx01 + t[1] * (dx11 - dx01);
      const double dy0 = x10 - x00, dy1 = x11 - x01;
      *gradient = Vector3d(dx0 + t[2] * (dx1 - dx0), dy0 + t[2] * (dy1 - dy0), y1 - y0) / spacing_;
    }
    return y0 + t[2] * (y1 - y0);
  }

  AlignedBox3d bounds_;
  AlignedBox3d grid_;
  double spacing_;
  Vector3i samples_;
  std::vector<float> values_;  // x runs fastest
};

double paddingSamples(double resolution, double spacing) { return std::ceil(kPadding * resolution / spacing); }

// May be more than an int holds.
Vector3d sampleCount(const AlignedBox3d& bounds, double resolution, double spacing) {
  return ((bounds.sizes() / spacing).array().ceil() + 1.0 + 2.0 * paddingSamples(resolution, spacing)).matrix();
}

double chooseSpacing(const AlignedBox3d& bounds, double resolution) {
  double spacing = std::min(resolution, bounds.sizes().minCoeff() / kLeastCellsAcross);
  while (spacing < resolution && sampleCount(bounds, resolution, spacing).prod() > kMostSamples) {
    spacing = std::min(resolution, 1.2 * spacing);
  }
  while (sampleCount(bounds, resolution, spacing).prod() > kSamplesAtAll) spacing *= 1.2;
  return spacing;
}

}  // namespace

std::shared_ptr<const SignedDistance> makeMeshDistance(const TriangleMesh& mesh, double resolution) {
  if (!(resolution > 0.0) || !std::isfinite(resolution)) {
    throw std::invalid_argument("makeMeshDistance: resolution " + std::to_string(resolution) +
                                " must be positive and finite");
  }
  static const bool initialized = (openvdb::initialize(), true);
  (void)initialized;

  const AlignedBox3d bounds = vertexBounds(mesh);
  const double spacing = chooseSpacing(bounds, resolution);
  const Vector3i samples = sampleCount(bounds, resolution, spacing).cast<int>();
  const Vector3d origin = bounds.center() - 0.5 * spacing * (samples.array() - 1).cast<double>().matrix();

  // In units of the spacing from the grid's first sample, so that OpenVDB's float coordinates stay small.
  std::vector<openvdb::Vec3s> points;
  for (const Vector3d& vertex : mesh.vertices) {
    const Vector3d p = (vertex - origin) / spacing;
    points.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const Vector3i& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> surface(points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  // Twice the padding: out to the corners of the grid, and some more for what the bounding box is wider.
  const float exterior = static_cast<float>(2 * paddingSamples(resolution, spacing) + 3);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      surface, *transform, exterior, std::numeric_limits<float>::max());

  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(samples.x()) * samples.y() * samples.z());
  const auto accessor = grid->getConstAccessor();
  for (int k = 0; k < samples.z(); ++k)
    for (int j = 0; j < samples.y(); ++j)
      for (int i = 0; i < samples.x(); ++i)
        values.push_back(static_cast<float>(spacing) * accessor.getValue(openvdb::Coord(i, j, k)));
  return std::make_shared<GridDistance>(bounds, origin, spacing, samples, std::move(values));
}

}  // namespace monolith
