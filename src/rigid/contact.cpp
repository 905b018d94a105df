#include "rigid/contact.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

#include "rigid/articulation.h"
#include "rigid/contact_reduction.h"
#include "rigid/convex_manifold.h"
#include "rigid/fcl_objects.h"
#include "rigid/mesh_manifold.h"
#include "rigid/wall_contact.h"

namespace monolith {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Indices of parts, and what shifts the second to that of its periodic images which is near the first.
struct PartPair {
  int a = 0, b = 0;
  std::array<int, 3> periods{};
  Vector3d shift = Vector3d::Zero();  // m
};

struct Part {
  int body;
  Shape shape;
  std::shared_ptr<const MeshSurface> surface;  // of a mesh
  std::unique_ptr<InflatedObject> object;
  bool free;
  Isometry3d X_WG = Isometry3d::Identity();

  bool isMesh() const { return surface != nullptr; }
};

// A part, or an image of it.
struct PlacedPart {
  const Part* part;
  Isometry3d X_WG;

  bool isMesh() const { return part->isMesh(); }
  PlacedMesh mesh() const { return {part->surface.get(), X_WG}; }
  ConvexShape convex() const { return placeConvex(part->shape, X_WG); }
};

PlacedPart place(const Part& part, const Vector3d& shift) {
  PlacedPart placed{&part, part.X_WG};
  placed.X_WG.translation() += shift;
  return placed;
}

bool collectPair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
  const auto* part_a = static_cast<const int*>(a->getUserData());
  const auto* part_b = static_cast<const int*>(b->getUserData());
  PartPair pair;
  std::tie(pair.a, pair.b) = std::minmax(*part_a, *part_b);
  static_cast<std::vector<PartPair>*>(pairs)->push_back(pair);
  return false;  // go on
}

// A guard for what the samples of a mesh miss: FCL's closest pair, if nothing found comes near it.
void appendClosestPair(const PlacedPart& a, const PlacedPart& b, double margin, std::vector<Contact>& contacts) {
  double most = margin;
  for (const Contact& contact : contacts) most = std::min(most, contact.gap - 0.05 * margin);
  if (most <= 0.0) return;
  const auto geometry = [](const PlacedPart& placed) { return placed.part->object->collisionGeometry(); };
  const ClosestPair pair = findClosestPair(*geometry(a), a.X_WG, *geometry(b), b.X_WG, most);
  if (pair.distance <= 0.0 || pair.distance >= most) return;
  const Vector3d offset = pair.on_a - pair.on_b;
  const double length = offset.norm();
  // Not taken on trust: iterative distances can end with points off the surfaces.
  const auto onSurface = [&](const PlacedPart& part, const Vector3d& point) {
    const DistanceSample sample = part.isMesh() ? part.mesh().sample(point) : sampleDistance(part.convex(), point);
    return std::abs(sample.distance) <= 1e-3 * margin;
  };
  if (length < 1e-3 * margin || !onSurface(a, pair.on_a) || !onSurface(b, pair.on_b)) return;
  contacts.push_back({0, 0, 0.5 * (pair.on_a + pair.on_b), offset / length, length});
}

void appendPartContacts(const PlacedPart& a, const PlacedPart& b, double margin, std::vector<Contact>& contacts) {
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
  if (b.part->shape.kind != Shape::Kind::kSphere) appendClosestPair(a, b, margin, found);
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
  std::set<std::pair<int, int>> apart;  // bodies that do not touch, the first before the second
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
    appendImages(pairs);
    const auto irrelevant = [&](const PartPair& pair) {
      const Part &a = parts[pair.a], &b = parts[pair.b];
      return a.body == b.body || !(a.free || b.free) || apart.count({a.body, b.body}) > 0;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), irrelevant), pairs.end());
    // The tree's order depends on its history. Bodies first: all of one pair of bodies together.
    const auto key = [&](const PartPair& p) {
      return std::make_tuple(parts[p.a].body, parts[p.b].body, p.periods, p.a, p.b);
    };
    std::sort(pairs.begin(), pairs.end(), [&](const PartPair& p, const PartPair& q) { return key(p) < key(q); });
    return pairs;
  }

  // Pairs of which one is in another image than the other. One of the two then reaches out of the tank.
  void appendImages(std::vector<PartPair>& pairs) const {
    if (!walls.periodic[0] && !walls.periodic[1] && !walls.periodic[2]) return;
    std::vector<Eigen::AlignedBox3d> boxes;
    std::vector<char> crosses;
    for (const Part& part : parts) {
      const fcl::AABBd& box = part.object->getAABB();
      boxes.emplace_back(Vector3d(box.min_), Vector3d(box.max_));
      bool out = false;
      for (int axis = 0; axis < 3; ++axis) {
        out = out || (walls.periodic[axis] && !(box.min_[axis] >= walls.inside.min()[axis] &&
                                                box.max_[axis] <= walls.inside.max()[axis]));
      }
      crosses.push_back(out ? 1 : 0);
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!crosses[i]) continue;
      for (std::size_t j = 0; j < parts.size(); ++j) {
        if (j == i || (crosses[j] && j < i)) continue;
        const std::size_t a = std::min(i, j), b = std::max(i, j);
        walls.forEachImage(boxes[a], boxes[b], [&](const Vector3d& shift, const std::array<int, 3>& periods) {
          pairs.push_back({static_cast<int>(a), static_cast<int>(b), periods, shift});
        });
      }
    }
  }
};

ContactDetector::ContactDetector(const std::vector<RigidBody>& bodies, const TankWalls& walls)
    : impl_(std::make_unique<Impl>()) {
  impl_->walls = walls;
  impl_->body_count = bodies.size();
  const std::vector<int> roots = rootsOf(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!mayTouch(bodies, roots, i, j)) impl_->apart.emplace(static_cast<int>(i), static_cast<int>(j));
    }
  }
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
    const PartPair& pair = pairs[job];
    const Part &a = parts[pair.a], &b = parts[pair.b];
    appendPartContacts(place(a, Vector3d::Zero()), place(b, pair.shift), margin, found[job]);
    for (Contact& contact : found[job]) {
      contact.body_a = a.body;
      contact.body_b = b.body;
      contact.shift_b = pair.shift;
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
    const Part &a = parts[pairs[i].a], &b = parts[pairs[i].b];
    of_pair.insert(of_pair.end(), found[i].begin(), found[i].end());
    const bool last =
        i + 1 == pairs.size() || parts[pairs[i + 1].a].body != a.body || parts[pairs[i + 1].b].body != b.body;
    if (!last) continue;
    // Shapes of one body that meet flush have corners in the same place, and images of one that spans the tank.
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
