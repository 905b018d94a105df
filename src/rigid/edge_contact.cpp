#include "rigid/edge_contact.h"

#include <cmath>

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kParallelSine = 0.05;
constexpr double kEndTolerance = 1e-6;                          // of an edge's length: crossings at an end count
const double kFacingTolerance = std::sin(10.0 * M_PI / 180.0);  // as for faces in rigid/convex_manifold.h

// Whether `direction` (at right angles to the edge) lies between the outward normals of the edge's two sides.
bool pointsOutAt(const SurfaceEdge& edge, const Vector3d& direction) {
  // The tangents of the two sides, away from the edge: the direction must lean towards neither.
  const Vector3d along = (edge.end - edge.start).normalized();
  Vector3d side_0 = edge.normal_0.cross(along);
  if (side_0.dot(edge.normal_1) > 0.0) side_0 = -side_0;
  Vector3d side_1 = edge.normal_1.cross(along);
  if (side_1.dot(edge.normal_0) > 0.0) side_1 = -side_1;
  return direction.dot(edge.normal_0 + edge.normal_1) > 0.0 && direction.dot(side_0) < kFacingTolerance &&
         direction.dot(side_1) < kFacingTolerance;
}

}  // namespace

std::vector<SurfaceEdge> boxEdges(const ConvexShape& box) {
  std::vector<SurfaceEdge> edges;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    for (const double u : {-1.0, 1.0}) {
      for (const double v : {-1.0, 1.0}) {
        const Vector3d middle = box.centre() + u * box.half[i] * box.axis(i) + v * box.half[j] * box.axis(j);
        const Vector3d half_edge = box.half[k] * box.axis(k);
        edges.push_back({middle - half_edge, middle + half_edge, u * box.axis(i), v * box.axis(j)});
      }
    }
  }
  return edges;
}

void appendCrossingEdges(const std::vector<SurfaceEdge>& edges_a, const std::vector<SurfaceEdge>& edges_b,
                         double margin, double deepest, std::vector<Contact>& contacts) {
  const auto within = [](double t) { return t >= -kEndTolerance && t <= 1.0 + kEndTolerance; };
  for (const SurfaceEdge& a : edges_a) {
    const Vector3d u = a.end - a.start;
    for (const SurfaceEdge& b : edges_b) {
      const Vector3d v = b.end - b.start;
      const Vector3d across = u.cross(v);
      const double squared = across.squaredNorm();
      if (squared < kParallelSine * kParallelSine * u.squaredNorm() * v.squaredNorm()) continue;
      const Vector3d offset = b.start - a.start;
      const double s = offset.cross(v).dot(across) / squared, t = offset.cross(u).dot(across) / squared;
      if (!within(s) || !within(t)) continue;
      Vector3d normal = across / std::sqrt(squared);
      if (normal.dot(b.normal_0 + b.normal_1) < 0.0) normal = -normal;
      const Vector3d on_a = a.start + s * u, on_b = b.start + t * v;
      const double gap = normal.dot(on_a - on_b);
      if (gap > margin || gap < -deepest || !pointsOutAt(b, normal) || !pointsOutAt(a, -normal)) continue;
      contacts.push_back({0, 0, 0.5 * (on_a + on_b), normal, gap});
    }
  }
}

void appendEdgesOnCylinder(const std::vector<SurfaceEdge>& edges, const ConvexShape& cylinder, double margin,
                           double deepest, std::vector<Contact>& contacts) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (const SurfaceEdge& edge : edges) {
    const auto at = [&](double t) { return sampleDistance(cylinder, edge.start + t * (edge.end - edge.start)); };
    // The distance to a convex solid is convex along a line.
    double low = 0.0, high = 1.0, t1 = 1.0 - golden, t2 = golden;
    double f1 = at(t1).distance, f2 = at(t2).distance;
    for (int i = 0; i < 45; ++i) {
      if (f1 > f2) {
        low = t1, t1 = t2, f1 = f2;
        t2 = low + golden * (high - low), f2 = at(t2).distance;
      } else {
        high = t2, t2 = t1, f2 = f1;
        t1 = high - golden * (high - low), f1 = at(t1).distance;
      }
    }
    const double t = 0.5 * (low + high);
    const DistanceSample sample = at(t);
    const bool inner = t > 1e-3 && t < 1.0 - 1e-3;
    if (!inner || sample.distance > margin || sample.distance < -deepest) continue;
    if (!pointsOutAt(edge, -sample.gradient)) continue;
    const Vector3d point = edge.start + t * (edge.end - edge.start) - 0.5 * sample.distance * sample.gradient;
    contacts.push_back({0, 0, point, sample.gradient, sample.distance});
  }
}

}  // namespace monolith
