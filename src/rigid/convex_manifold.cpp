#include "rigid/convex_manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/contact_reduction.h"
#include "rigid/convex_separation.h"
#include "rigid/segment.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

const double kFaceSine = std::sin(10.0 * M_PI / 180.0);
constexpr double kClipTolerance = 1e-9;  // m; a corner on the boundary is inside
constexpr double kMergeFraction = 1e-4;  // of the thinner shape
constexpr double kMissedFraction = 1e-3;

double thickness(const ConvexShape& shape) {
  return shape.kind == Shape::Kind::kBox ? shape.half.minCoeff() : std::min(shape.radius, shape.half_length);
}

// Part of `polygon` (or line, or point) in the prism over `face`.
Polygon clipToPrism(Polygon polygon, const Face& face) {
  const std::size_t sides = face.polygon.size();
  for (std::size_t i = 0; i < sides && !polygon.empty(); ++i) {
    const Vector3d& corner = face.polygon[i];
    const Vector3d outward = (face.polygon[(i + 1) % sides] - corner).cross(face.normal).normalized();
    const auto outside = [&](const Vector3d& p) { return outward.dot(p - corner); };
    Polygon kept;
    for (std::size_t j = 0; j < polygon.size(); ++j) {
      const Vector3d& p = polygon[j];
      const Vector3d& q = polygon[(j + 1) % polygon.size()];
      const double dp = outside(p), dq = outside(q);
      if (dp <= kClipTolerance) kept.push_back(p);
      // Where both are at the boundary to round-off, the crossing is still between them.
      if ((dp > kClipTolerance) != (dq > kClipTolerance)) {
        kept.push_back(p + (q - p) * std::clamp(dp / (dp - dq), 0.0, 1.0));
      }
    }
    polygon = std::move(kept);
  }
  return polygon;
}

void appendFaceContacts(const Face& face, const ConvexShape& other, bool face_is_of_a, double margin,
                        std::vector<Contact>& contacts) {
  const Polygon piece = pieceTowards(other, -face.normal);
  for (const Vector3d& point : clipToPrism(piece, face)) {
    Contact contact;
    contact.gap = face.normal.dot(point - face.polygon.front());
    if (contact.gap > margin) continue;
    contact.normal = face_is_of_a ? Vector3d(-face.normal) : face.normal;
    contact.point = point - 0.5 * contact.gap * face.normal;
    if (std::find(piece.begin(), piece.end(), point) != piece.end()) contact.share_a = face_is_of_a ? 0.0 : 1.0;
    contacts.push_back(contact);
  }
}

// The pair of edges that faces each other along n; of two faces the nearest pair of their sides.
void appendEdgeContacts(const ConvexShape& a, const ConvexShape& b, const Separation& separation, bool faces,
                        double margin, std::vector<Contact>& contacts) {
  const Vector3d& n = separation.normal;
  const auto append = [&](const Vector3d& on_a, const Vector3d& on_b) {
    const double gap = n.dot(on_a - on_b);
    if (gap <= margin) contacts.push_back({0, 0, 0.5 * (on_a + on_b), n, gap});
  };
  if (!faces) {
    const Polygon edge_a = edgeTowards(a, -n), edge_b = edgeTowards(b, n);
    Polygon on_a, on_b;
    if (parallelOverlap(edge_a, edge_b, kFaceSine, on_a, on_b)) {
      for (std::size_t i = 0; i < on_a.size(); ++i) append(on_a[i], on_b[i]);
      return;
    }
    const PointPair pair = nearestPoints(edge_a.front(), edge_a.back(), edge_b.front(), edge_b.back());
    contacts.push_back({0, 0, 0.5 * (pair.first + pair.second), n, separation.distance});
    return;
  }
  const Polygon piece_a = pieceTowards(a, -n), piece_b = pieceTowards(b, n);
  PointPair nearest{a.centre(), b.centre()};
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < piece_a.size(); ++i) {
    for (std::size_t j = 0; j < piece_b.size(); ++j) {
      const PointPair pair =
          nearestPoints(piece_a[i], piece_a[(i + 1) % piece_a.size()], piece_b[j], piece_b[(j + 1) % piece_b.size()]);
      const double distance = (pair.first - pair.second).norm();
      if (distance < least) least = distance, nearest = pair;
    }
  }
  contacts.push_back({0, 0, 0.5 * (nearest.first + nearest.second), n, separation.distance});
}

// Contact::share_a where one is a sphere: with two, the smaller has more of it; a ball rolls on all else as on a plane.
double sphereShare(const ConvexShape& a, const ConvexShape& b) {
  if (b.kind != Shape::Kind::kSphere) return 1.0;
  if (a.kind != Shape::Kind::kSphere) return 0.0;
  return b.radius / (a.radius + b.radius);
}

}  // namespace

void appendConvexContacts(const ConvexShape& a, const ConvexShape& b, double margin, std::vector<Contact>& contacts) {
  const Separation separation = findSeparation(a, b);
  if (separation.distance > margin) return;
  const Vector3d& n = separation.normal;
  const bool a_is_sphere = a.kind == Shape::Kind::kSphere;
  if (a_is_sphere || b.kind == Shape::Kind::kSphere) {
    const Vector3d surface = a_is_sphere ? Vector3d(a.centre() - a.radius * n) : Vector3d(b.centre() + b.radius * n);
    const Vector3d point = surface + (a_is_sphere ? -0.5 : 0.5) * separation.distance * n;
    contacts.push_back({0, 0, point, n, separation.distance, sphereShare(a, b)});
    return;
  }
  const Face face_a = faceTowards(a, -n), face_b = faceTowards(b, n);
  const double sine_a = face_a.normal.dot(-n) > 0.0 ? face_a.normal.cross(n).norm() : 1.0;
  const double sine_b = face_b.normal.dot(n) > 0.0 ? face_b.normal.cross(n).norm() : 1.0;
  const bool faces = std::min(sine_a, sine_b) < kFaceSine;
  std::vector<Contact> found;
  if (faces) {
    // Of two faces as good as one another either does; b's, so that the choice does not hang on round-off.
    const bool take_a = sine_a < sine_b - 1e-9;
    appendFaceContacts(take_a ? face_a : face_b, take_a ? b : a, take_a, margin, found);
  }
  if (found.empty()) {
    appendEdgeContacts(a, b, separation, faces, margin, found);
  } else {
    // What lies over the face may miss where they are nearest: a cylinder's side across a box's edge.
    const auto shallower = [](const Contact& p, const Contact& q) { return p.gap < q.gap; };
    const double least = std::min_element(found.begin(), found.end(), shallower)->gap;
    const double missed = kMissedFraction * std::min(thickness(a), thickness(b));
    if (least > separation.distance + missed) appendEdgeContacts(a, b, separation, false, margin, found);
  }
  mergeCoincident(found, kMergeFraction * std::min(thickness(a), thickness(b)));
  reduceContacts(found, kMostPointsPerConvexPair);
  contacts.insert(contacts.end(), found.begin(), found.end());
}

}  // namespace monolith
