#include "rigid/mesh_manifold.h"

#include <algorithm>

#include "rigid/contact_reduction.h"
#include "rigid/corner_contact.h"
#include "rigid/edge_contact.h"

namespace monolith {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Kind = Shape::Kind;

constexpr double kSlackOfMargin = 0.1;   // how far over an edge a corner still rests on the face
constexpr double kSlackOfSize = 1e-6;    // ... at the least, of the mesh's diagonal
constexpr double kMergeFraction = 1e-4;  // of the mesh's diagonal
constexpr double kDeepestEdge = 0.1;     // of the diagonal: crossing edges farther in belong to other sides

double size(const PlacedMesh& mesh) { return mesh.surface->bounds().diagonal().norm(); }

double slackFor(const PlacedMesh& mesh, double margin) { return kSlackOfMargin * margin + kSlackOfSize * size(mesh); }

AlignedBox3d worldBounds(const PlacedMesh& mesh) {
  AlignedBox3d box = mesh.surface->bounds();
  return box.transformed(mesh.X_WG);
}

AlignedBox3d worldBounds(const ConvexShape& shape) {
  AlignedBox3d box;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {-1.0, 1.0}) box.extend(supportPoint(shape, side * Vector3d::Unit(k)));
  }
  return box;
}

AlignedBox3d inflated(const AlignedBox3d& box, double by) {
  const Vector3d offset = Vector3d::Constant(by);
  return AlignedBox3d(box.min() - offset, box.max() + offset);
}

std::vector<Corner> cornersWithin(const PlacedMesh& mesh, const AlignedBox3d& box) {
  std::vector<Corner> corners;
  const auto& vertices = mesh.surface->vertices();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3d point = mesh.X_WG * vertices[i];
    if (box.contains(point)) corners.push_back({point, mesh.X_WG.linear() * mesh.surface->vertexNormals()[i]});
  }
  return corners;
}

std::vector<SurfaceEdge> edgesWithin(const PlacedMesh& mesh, const AlignedBox3d& box) {
  std::vector<SurfaceEdge> edges;
  const Eigen::Matrix3d& R = mesh.X_WG.linear();
  for (const SurfaceEdge& edge : mesh.surface->convexEdges()) {
    const Vector3d start = mesh.X_WG * edge.start, end = mesh.X_WG * edge.end;
    if (!box.intersects(AlignedBox3d(start.cwiseMin(end), start.cwiseMax(end)))) continue;
    edges.push_back({start, end, R * edge.normal_0, R * edge.normal_1});
  }
  return edges;
}

// Contacts with normals away from the mesh: of the corners of something else on it.
void appendCornersOn(const PlacedMesh& mesh, const std::vector<Corner>& corners, double margin,
                     std::vector<Contact>& contacts) {
  const AlignedBox3d reach = inflated(mesh.surface->bounds(), margin);
  const Eigen::Isometry3d X_GW = mesh.X_WG.inverse();
  for (const Corner& corner : corners) {
    const Vector3d point = X_GW * corner.point;
    DistanceSample sample;
    if (!reach.contains(point) ||
        !mesh.surface->sampleFacing(point, X_GW.linear() * corner.normal, slackFor(mesh, margin), sample)) {
      continue;
    }
    appendCorner(corner, {sample.distance, mesh.X_WG.linear() * sample.gradient}, margin, contacts);
  }
}

void turnNormals(std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) contact.turn();
}

void finish(std::vector<Contact>& found, double merge_distance, std::vector<Contact>& contacts) {
  mergeCoincident(found, merge_distance);
  reduceContacts(found, kMostPointsPerMeshPair);
  contacts.insert(contacts.end(), found.begin(), found.end());
}

void appendSphereContacts(const PlacedMesh& mesh, const ConvexShape& sphere, double margin,
                          std::vector<Contact>& contacts) {
  const Vector3d centre = mesh.X_WG.inverse() * sphere.centre();
  const DistanceSample nearest = mesh.surface->sample(centre);
  const auto append = [&](const Vector3d& outward, double gap) {
    const Vector3d n = mesh.X_WG.linear() * outward;  // towards the sphere, which is b
    contacts.push_back({0, 0, sphere.centre() - (sphere.radius + 0.5 * gap) * n, -n, gap, 0.0});
  };
  if (nearest.distance - sphere.radius > margin) return;
  if (nearest.distance <= 1e-9 * size(mesh)) {
    append(nearest.gradient, nearest.distance - sphere.radius);
    return;
  }
  for (const Vector3d& point : mesh.surface->localNearestPoints(centre, sphere.radius + margin)) {
    const double distance = (centre - point).norm();
    append((centre - point) / distance, distance - sphere.radius);
  }
}

}  // namespace

DistanceSample PlacedMesh::sample(const Vector3d& point) const {
  DistanceSample sample = surface->sample(X_WG.inverse() * point);
  sample.gradient = X_WG.linear() * sample.gradient;
  return sample;
}

void appendMeshContacts(const PlacedMesh& a, const PlacedMesh& b, double margin, std::vector<Contact>& contacts) {
  const AlignedBox3d box_a = inflated(worldBounds(a), margin), box_b = inflated(worldBounds(b), margin);
  const double least_size = std::min(size(a), size(b));
  std::vector<Contact> found;
  appendCornersOn(a, cornersWithin(b, box_a), margin, found);
  turnNormals(found);
  appendCornersOn(b, cornersWithin(a, box_b), margin, found);
  appendCrossingEdges(edgesWithin(a, box_b), edgesWithin(b, box_a), margin, kDeepestEdge * least_size, found);
  finish(found, kMergeFraction * least_size, contacts);
}

void appendMeshContacts(const PlacedMesh& a, const ConvexShape& b, double margin, std::vector<Contact>& contacts) {
  std::vector<Contact> found;
  if (b.kind == Kind::kSphere) {
    appendSphereContacts(a, b, margin, found);
    finish(found, kMergeFraction * size(a), contacts);
    return;
  }
  const AlignedBox3d box_b = inflated(worldBounds(b), margin);
  appendCornersOn(a, cornersFacing(b, a), margin, found);
  turnNormals(found);
  for (const Corner& corner : cornersWithin(a, box_b)) {
    DistanceSample sample;
    if (sampleFacing(b, corner.point, corner.normal, slackFor(a, margin), sample)) {
      appendCorner(corner, sample, margin, found);
    }
  }
  const std::vector<SurfaceEdge> edges = edgesWithin(a, box_b);
  const double least_size = std::min(size(a), (box_b.sizes().array() - 2.0 * margin).matrix().norm());
  if (b.kind == Kind::kBox) {
    appendCrossingEdges(edges, boxEdges(b), margin, kDeepestEdge * least_size, found);
  } else {
    appendEdgesOnCylinder(edges, b, margin, kDeepestEdge * least_size, found);
  }
  finish(found, kMergeFraction * least_size, contacts);
}

}  // namespace monolith
