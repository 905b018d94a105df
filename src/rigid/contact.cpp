#include "rigid/contact.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>
#include <tuple>

#include "rigid/contact_reduction.h"
#include "rigid/convex_manifold.h"
#include "rigid/fcl_objects.h"
#include "rigid/mesh_manifold.h"
#include "rigid/wall_contact.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using PartPair = std::pair<int, int>;

struct Part {
  int body;
  Shape shape;
  std::shared_ptr<const MeshSurface> surface;  // of a mesh
  std::unique_ptr<InflatedObject> object;
  bool free;
  Isometry3d X_WG = Isometry3d::Identity();

  bool isMesh() const { return surface != nullptr; }
  PlacedMesh mesh() const { return {surface.get(), X_WG}; }
  ConvexShape convex() const { return placeConvex(shape, X_WG); }
};

bool collectPair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
  const auto* part_a = static_cast<const int*>(a->getUserData());
  const auto* part_b = static_cast<const int*>(b->getUserData());
  static_cast<std::vector<PartPair>*>(pairs)->push_back(std::minmax(*part_a, *part_b));
  return false;  // go on
}

// A guard for what the samples of a mesh miss: FCL's closest pair, if nothing found comes near it.
void appendClosestPair(const Part& a, const Part& b, double margin, std::vector<Contact>& contacts) {
  double most = margin;
  for (const Contact& contact : contacts) most = std::min(most, contact.gap - 0.05 * margin);
  if (most <= 0.0) return;
  const ClosestPair pair = findClosestPair(*a.object, *b.object, most);
  if (pair.distance <= 0.0 || pair.distance >= most) return;
  const Vector3d offset = pair.on_a - pair.on_b;
  const double length = offset.norm();
  // Not taken on trust: iterative distances can end with points off the surfaces.
  const auto onSurface = [&](const Part& part, const Vector3d& point) {
    const DistanceSample sample = part.isMesh() ? part.mesh().sample(point) : sampleDistance(part.convex(), point);
    return std::abs(sample.distance) <= 1e-3 * margin;
  };
  if (length < 1e-3 * margin || !onSurface(a, pair.on_a) || !onSurface(b, pair.on_b)) return;
  contacts.push_back({0, 0, 0.5 * (pair.on_a + pair.on_b), offset / length, length});
}

void appendPartContacts(const Part& a, const Part& b, double margin, std::vector<Contact>& contacts) {
  if (!a.isMesh() && !b.isMesh()) {
    appendConvexContacts(a.convex(), b.convex(), margin, contacts);
    return;
  }
  if (!a.isMesh()) {
    const std::size_t before = contacts.size();
    appendPartContacts(b, a, margin, contacts);
    for (std::size_t i = before; i < contacts.size(); ++i) contacts[i].turn();
    return;
  }
  std::vector<Contact> found;
  if (b.isMesh()) {
    appendMeshContacts(a.mesh(), b.mesh(), margin, found);
  } else {
    appendMeshContacts(a.mesh(), b.convex(), margin, found);
  }
  if (b.shape.kind != Shape::Kind::kSphere) appendClosestPair(a, b, margin, found);
  contacts.insert(contacts.end(), found.begin(), found.end());
}

void appendContactsWithWalls(const Part& part, const TankWalls& walls, double margin, std::vector<Contact>& contacts) {
  if (!part.free) return;
  static const std::vector<Vector3d> kNoVertices;
  const auto& vertices = part.isMesh() ? part.surface->vertices() : kNoVertices;
  appendWallContacts(part.body, part.shape, part.X_WG, vertices, walls, margin, contacts);
}

}  // namespace

struct ContactDetector::Impl {
  TankWalls walls;
  std::size_t body_count = 0;
  std::vector<Part> parts;      // by body, then shape
  std::vector<int> part_index;  // what the objects' user data point at
  fcl::DynamicAABBTreeCollisionManagerd manager;

  void place(const std::vector<RigidBody>& bodies, double margin) {
    for (Part& part : parts) {
      part.X_WG = bodies[part.body].pose() * part.shape.X_BG;
      part.object->place(part.X_WG, 0.5 * margin);
    }
    manager.update();
  }

  std::vector<PartPair> nearPairs() {
    std::vector<PartPair> pairs;
    manager.collide(&pairs, &collectPair);
    const auto irrelevant = [&](const PartPair& pair) {
      const Part &a = parts[pair.first], &b = parts[pair.second];
      return a.body == b.body || !(a.free || b.free);
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), irrelevant), pairs.end());
    // The tree's order depends on its history. Bodies first: all of one pair of bodies together.
    std::sort(pairs.begin(), pairs.end(), [&](const PartPair& p, const PartPair& q) {
      return std::make_tuple(parts[p.first].body, parts[p.second].body, p) <
             std::make_tuple(parts[q.first].body, parts[q.second].body, q);
    });
    return pairs;
  }
};

ContactDetector::ContactDetector(const std::vector<RigidBody>& bodies, const TankWalls& walls)
    : impl_(std::make_unique<Impl>()) {
  impl_->walls = walls;
  impl_->body_count = bodies.size();
  std::map<const TriangleMesh*, std::shared_ptr<const MeshSurface>> surfaces;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const Shape& shape : bodies[i].shapes) {
      Part part;
      part.body = static_cast<int>(i);
      part.shape = shape;
      part.free = bodies[i].motion == BodyMotion::kFree;
      if (shape.kind == Shape::Kind::kMesh) {
        auto& surface = surfaces[shape.mesh.get()];
        if (!surface) surface = std::make_shared<MeshSurface>(*shape.mesh);
        part.surface = surface;
      }
      part.object = std::make_unique<InflatedObject>(makeCollisionGeometry(shape));
      impl_->parts.push_back(std::move(part));
    }
  }
  impl_->part_index.resize(impl_->parts.size());
  for (std::size_t i = 0; i < impl_->parts.size(); ++i) {
    impl_->part_index[i] = static_cast<int>(i);
    impl_->parts[i].object->setUserData(&impl_->part_index[i]);
    impl_->manager.registerObject(impl_->parts[i].object.get());
  }
  impl_->manager.setup();
}

ContactDetector::~ContactDetector() = default;

std::vector<Contact> ContactDetector::detect(const std::vector<RigidBody>& bodies, double margin) {
  if (bodies.size() != impl_->body_count) {
    throw std::invalid_argument("ContactDetector::detect: " + std::to_string(bodies.size()) +
                                " bodies given, made for " + std::to_string(impl_->body_count));
  }
  impl_->place(bodies, margin);
  const std::vector<Part>& parts = impl_->parts;
  const std::vector<PartPair> pairs = impl_->nearPairs();
  // Pairs and walls apart from each other, by whoever is free; what they find is taken in their order.
  std::vector<std::vector<Contact>> found(pairs.size() + parts.size());
  const auto find = [&](std::size_t job) {
    if (job >= pairs.size()) {
      appendContactsWithWalls(parts[job - pairs.size()], impl_->walls, margin, found[job]);
      return;
    }
    const Part &a = parts[pairs[job].first], &b = parts[pairs[job].second];
    appendPartContacts(a, b, margin, found[job]);
    for (Contact& contact : found[job]) {
      contact.body_a = a.body;
      contact.body_b = b.body;
    }
  };
  std::vector<std::exception_ptr> thrown(found.size());
#pragma omp parallel for schedule(dynamic) if (!pairs.empty())
  for (std::size_t job = 0; job < found.size(); ++job) {
    try {
      find(job);
    } catch (...) {
      thrown[job] = std::current_exception();
    }
  }
  for (const std::exception_ptr& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
  std::vector<Contact> contacts;
  std::vector<Contact> of_pair;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Part &a = parts[pairs[i].first], &b = parts[pairs[i].second];
    of_pair.insert(of_pair.end(), found[i].begin(), found[i].end());
    const bool last =
        i + 1 == pairs.size() || parts[pairs[i + 1].first].body != a.body || parts[pairs[i + 1].second].body != b.body;
    if (!last) continue;
    // Shapes of one body that meet flush have corners in the same place.
    mergeCoincident(of_pair, 1e-3 * margin);
    contacts.insert(contacts.end(), of_pair.begin(), of_pair.end());
    of_pair.clear();
  }
  for (std::size_t i = pairs.size(); i < found.size(); ++i) {
    contacts.insert(contacts.end(), found[i].begin(), found[i].end());
  }
  return contacts;
}

}  // namespace monolith
