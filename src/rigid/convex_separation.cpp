#include "rigid/convex_separation.h"

#include <cmath>
#include <vector>

namespace monolith {
namespace {

using Eigen::Vector3d;
using Kind = Shape::Kind;

const double kGolden = 0.5 * (std::sqrt(5.0) - 1.0);

// Collects directions and keeps the best; earlier ones win ties, so that faces come before edges.
class Search {
 public:
  Search(const ConvexShape& a, const ConvexShape& b) : a_(a), b_(b), offset_(a.centre() - b.centre()) {}

  double value(const Vector3d& n) const { return separationAlong(a_, b_, n); }

  void tryDirection(const Vector3d& direction) {
    const double norm = direction.norm();
    if (norm < 1e-9) return;
    const Vector3d n = direction / norm;
    const double s = value(n);
    if (!found_ || s > best_.distance + 1e-13) best_ = {n, s};
    found_ = true;
  }
  void tryBoth(const Vector3d& direction) {
    const double side = direction.dot(offset_) < 0.0 ? -1.0 : 1.0;
    tryDirection(side * direction);
    tryDirection(-side * direction);
  }
  // From the nearest point of the other shape, if that is apart.
  void tryPoint(const Vector3d& point, bool of_a) {
    const DistanceSample sample = sampleDistance(of_a ? b_ : a_, point);
    if (sample.distance > 0.0) tryDirection(of_a ? sample.gradient : Vector3d(-sample.gradient));
  }
  const Separation& best() const { return best_; }

 private:
  const ConvexShape& a_;
  const ConvexShape& b_;
  Vector3d offset_;
  Separation best_{Vector3d::UnitZ(), 0.0};
  bool found_ = false;
};

// Where f is largest between two angles: golden section.
template <typename Function>
double largestBetween(double low, double high, const Function& f) {
  double x1 = high - kGolden * (high - low), x2 = low + kGolden * (high - low);
  double f1 = f(x1), f2 = f(x2);
  for (int i = 0; i < 40; ++i) {
    if (f1 < f2) {
      low = x1, x1 = x2, f1 = f2;
      x2 = low + kGolden * (high - low), f2 = f(x2);
    } else {
      high = x2, x2 = x1, f2 = f1;
      x1 = high - kGolden * (high - low), f1 = f(x1);
    }
  }
  return 0.5 * (low + high);
}

// Every local maximum of f on the circle that sampling tells apart.
template <typename Function>
std::vector<double> peaksOnCircle(const Function& f) {
  constexpr int kSamples = 48;
  const double spacing = 2.0 * M_PI / kSamples;
  double values[kSamples];
  for (int i = 0; i < kSamples; ++i) values[i] = f(i * spacing);
  std::vector<double> peaks;
  for (int i = 0; i < kSamples; ++i) {
    if (values[i] < values[(i + 1) % kSamples] || values[i] < values[(i + kSamples - 1) % kSamples]) continue;
    peaks.push_back(largestBetween((i - 1) * spacing, (i + 1) * spacing, f));
  }
  return peaks;
}

// Normals at right angles to a straight edge or side line: s has a ridge along them.
void tryAround(Search& search, const Vector3d& edge) {
  const Vector3d u = edge.unitOrthogonal();
  const Vector3d w = edge.cross(u);
  const auto direction = [&](double angle) -> Vector3d { return std::cos(angle) * u + std::sin(angle) * w; };
  const auto value = [&](double angle) { return search.value(direction(angle)); };
  // Apart, the only peak above zero may be narrower than the sampling, but it is near the best so far.
  const Vector3d best = search.best().normal;
  const double near = std::atan2(best.dot(w), best.dot(u));
  search.tryDirection(direction(largestBetween(near - 0.1, near + 0.1, value)));
  if (search.best().distance > 0.0) return;
  for (const double angle : peaksOnCircle(value)) search.tryDirection(direction(angle));
}

// The rim point of one cylinder that is nearest to the other shape.
void tryRims(Search& search, const ConvexShape& cylinder, const ConvexShape& other, bool of_a) {
  for (const double side : {-1.0, 1.0}) {
    const auto point = [&](double angle) -> Vector3d {
      return cylinder.X_WG * Vector3d(cylinder.radius * std::cos(angle), cylinder.radius * std::sin(angle),
                                      side * cylinder.half_length);
    };
    const auto nearness = [&](double angle) { return -sampleDistance(other, point(angle)).distance; };
    for (const double angle : peaksOnCircle(nearness)) search.tryPoint(point(angle), of_a);
  }
}

void tryAxes(Search& search, const ConvexShape& a, const ConvexShape& b) {
  const auto first = [](const ConvexShape& s) { return s.kind == Kind::kBox ? 0 : 2; };
  for (int i = first(a); i < 3; ++i) search.tryBoth(a.axis(i));
  for (int j = first(b); j < 3; ++j) search.tryBoth(b.axis(j));
  for (int i = first(a); i < 3; ++i)
    for (int j = first(b); j < 3; ++j)
      if (a.axis(i).cross(b.axis(j)).norm() > 1e-6) search.tryBoth(a.axis(i).cross(b.axis(j)));
  // Side by side, parallel: across the axis.
  const Vector3d offset = a.centre() - b.centre();
  for (const ConvexShape* s : {&a, &b}) {
    if (s->kind == Kind::kCylinder) search.tryDirection(offset - s->axis(2) * s->axis(2).dot(offset));
  }
}

// Climbs s over the sphere of directions from the best so far; for what no candidate above covers exactly. s has
// ridges, which only some directions climb: the cross of trial steps turns from round to round.
void climb(Search& search) {
  const double golden_angle = 2.0 * M_PI * kGolden;
  int round = 0;
  for (double step = 0.2; step > 1e-8 && round < 400; ++round) {
    const Separation before = search.best();
    const Vector3d x = before.normal.unitOrthogonal();
    const Vector3d y = before.normal.cross(x);
    for (int i = 0; i < 4; ++i) {
      const double angle = round * golden_angle + 0.5 * M_PI * i;
      search.tryDirection(before.normal + step * (std::cos(angle) * x + std::sin(angle) * y));
    }
    if (search.best().distance <= before.distance + 1e-3 * kGolden * step * std::abs(before.distance)) step *= 0.8;
  }
}

// Overlapping: s has several hills. A first look from evenly spread directions (a Fibonacci lattice).
void tryEverywhere(Search& search) {
  const int count = 200;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
    const double angle = 2.0 * M_PI * kGolden * i;
    search.tryDirection(Vector3d(r * std::cos(angle), r * std::sin(angle), z));
  }
}

}  // namespace

double separationAlong(const ConvexShape& a, const ConvexShape& b, const Vector3d& normal) {
  return normal.dot(supportPoint(a, -normal) - supportPoint(b, normal));
}

Separation findSeparation(const ConvexShape& a, const ConvexShape& b) {
  if (a.kind == Kind::kSphere || b.kind == Kind::kSphere) {
    const bool a_is_sphere = a.kind == Kind::kSphere;
    const ConvexShape& sphere = a_is_sphere ? a : b;
    const DistanceSample sample = sampleDistance(a_is_sphere ? b : a, sphere.centre());
    const double side = a_is_sphere ? 1.0 : -1.0;
    return {side * sample.gradient, sample.distance - sphere.radius};
  }
  Search search(a, b);
  tryAxes(search, a, b);
  if (a.kind == Kind::kBox)
    for (const Vector3d& corner : boxCorners(a)) search.tryPoint(corner, true);
  if (b.kind == Kind::kBox)
    for (const Vector3d& corner : boxCorners(b)) search.tryPoint(corner, false);
  if (a.kind == Kind::kBox && b.kind == Kind::kBox) return search.best();
  if (a.kind == Kind::kCylinder) tryRims(search, a, b, true);
  if (b.kind == Kind::kCylinder) tryRims(search, b, a, false);
  if (search.best().distance < 0.0) tryEverywhere(search);
  climb(search);
  for (const ConvexShape* shape : {&a, &b}) {
    for (int k = shape->kind == Kind::kBox ? 0 : 2; k < 3; ++k) tryAround(search, shape->axis(k));
  }
  climb(search);
  return search.best();
}

}  // namespace monolith
