#include "coupling/sticking_liquid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "coupling/body_rows.h"
#include "coupling/narrow_gaps.h"
#include "coupling/stokes_coefficients.h"
#include "geometry/wall_thickness.h"
#include "solve/marked_entries.h"

namespace monolith {
namespace {

// What a face keeps beyond the linear share for each surface that cuts a segment of it. A linear share makes the speeds
// in a plane channel exact and its flow rate too small by (h/H)^2; 1/12 more would make the flow rate exact, in the
// mean over the surface's places in the grid. At walls of the tank, always half a cell away, it is 1/12 too, and 1/4 is
// nothing stuck. Around spheres the layer is curved: these are the values with which arrays, and boxes at 4 and 10
// cells across, come out best.
constexpr double kExtraAtBody = 1.0 / 24.0;
constexpr double kExtraAtWall = 1.0 / 6.0;

// Place of a cell in a body's box, in the periodic image that is nearest to the body; false outside.
bool localCell(const Lattice& l, const BodyFractions& f, const std::array<int, 3>& cell, std::array<int, 3>& local) {
  for (int a = 0; a < 3; ++a) {
    local[a] = l.wrapped(a, cell[a] - f.low[a]);
    if (l.periodic[a]) {
      // A box longer than the period holds a cell twice.
      const auto offCentre = [&](int at) { return std::abs(2 * at - f.count[a] + 1); };
      while (local[a] + l.n[a] < f.count[a] && offCentre(local[a] + l.n[a]) < offCentre(local[a])) local[a] += l.n[a];
    }
    if (local[a] < 0 || local[a] >= f.count[a]) return false;
  }
  return true;
}

// Cell widths. A wall as thick has, wherever it lies in the grid, a layer of faces without liquid.
constexpr double kThinWall = 2.0;
// Times a wall's thickness is it through where three of them meet: sqrt(3), and a little more.
constexpr double kThroughCorner = 1.75;

// Cells from a wall beyond which it is not next.
constexpr int kBesideWall = 2;

bool isClear(const Lattice& l, int axis, int at) {
  return l.periodic[axis] || (at >= kBesideWall && at < l.n[axis] - kBesideWall);
}

// Makes the parts, of which nothing is left in the liquid, the bodies'. Returns the inertia of their liquid.
std::vector<Matrix6d> giveToBodies(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                   const std::vector<double>& liquid_distance, const std::vector<StickingPart>& parts,
                                   SolidFractions& solids) {
  const Lattice& l = grid.lattice;
  std::vector<Matrix6d> inertia(bodies.size(), Matrix6d::Zero());
  for (const auto& [a, f, body, part] : parts) {
    if (body < 0) continue;
    BodyFractions& fractions = solids.bodies[body];
    std::array<int, 3> local;
    if (!localCell(l, fractions, l.cell(f), local)) continue;
    fractions.face[a][fractions.local(local[0], local[1], local[2])] += part;
    const double mass = part * liquidPart(liquid_distance[f - l.stride[a]], liquid_distance[f]);
    if (mass == 0.0) continue;
    // In the image next to the body.
    const Eigen::Vector3d x =
        grid.faceCenter(a, fractions.low[0] + local[0], fractions.low[1] + local[1], fractions.low[2] + local[2]);
    const Vector6d row = velocityRow(a, x, bodies[body].p_WBcm);
    inertia[body] += mass * row * row.transpose();
  }
  for (auto& field : solids.fluid) fillHalo(l, field);
  return inertia;
}

}  // namespace

double stickingViscosity(double density, double speed, double cell_width) {
  constexpr double kLeastLayer = 0.1;
  return kLeastLayer * density * speed * cell_width;
}

std::vector<Matrix6d> attachStickingLiquid(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                           const std::vector<double>& liquid_distance, SolidFractions& solids) {
  const Lattice& l = grid.lattice;
  const std::vector<std::uint8_t> near_body = rowsOfBodies(l, solids.bodies);
  // Of every plane of faces of every axis; put together in order.
  const int planes = l.faceEnd(2);
  std::vector<std::vector<StickingPart>> found(3 * planes);
#pragma omp parallel for schedule(dynamic)
  for (int at = 0; at < 3 * planes; ++at) {
    const int a = at / planes, k = at % planes;
    const auto& distance = solids.distance[a];
    const auto& owner = solids.owner[a];
    auto& fluid = solids.fluid[a];
    thread_local RowMarks marks;
    for (int j = 0; j < l.faceEnd(1); ++j) {
      // Far from all of them and from the walls beside it only a row's ends are next to a solid.
      const bool between =
          !near_body[j + static_cast<std::size_t>(l.faceEnd(1)) * k] && isClear(l, 1, j) && isClear(l, 2, k);
      const auto row = l.index(0, j, k);
      std::uint8_t* next_to_solid = marks.start(l.faceEnd(0));
      const auto markFaces = [&](int begin, int end) {
        const double* of_liquid = fluid.data() + row;
        const float* away = distance.data() + row;
#pragma omp simd
        for (int i = begin; i < end; ++i) next_to_solid[i] = (of_liquid[i] > 0.0) & (away[i] < 1.0F);
      };
      if (between && l.faceEnd(0) > 2 * kBesideWall) {
        markFaces(0, kBesideWall);
        markFaces(l.faceEnd(0) - kBesideWall, l.faceEnd(0));
      } else {
        markFaces(0, l.faceEnd(0));
      }
      marks.forEach([&](std::ptrdiff_t i) {
        const auto f = row + i;
        const double here = distance[f];
        double kept = 0.0;
        int body = owner[f];
        if (here > 0.0) {
          kept = 1.0;
          double nearest = 1.0;
          for (int b = 0; b < 3; ++b) {
            double share = 0.0;
            for (const auto step : {-l.stride[b], l.stride[b]}) {
              const double beyond = distance[f + step];
              double theta = 1.0;
              if (beyond <= 0.0) {
                // The distance here may be that of a body: walls lie on faces, whatever else is near.
                const bool wall = owner[f + step] < 0;
                theta = !wall ? here / (here - beyond) : a == b ? 1.0 : 0.5;
                share += wall ? kExtraAtWall : kExtraAtBody;
                if (theta < nearest) {
                  nearest = theta;
                  body = owner[f + step];
                }
              }
              share += 0.5 * theta;
            }
            kept = std::min(kept, share);
          }
        }
        if (kept >= fluid[f]) return;
        if (body >= 0 || kept == 0.0) found[at].push_back({a, f, body, fluid[f] - kept});
        fluid[f] = kept;
      });
    }
  }
  std::vector<StickingPart> parts;
  for (const auto& plane : found) parts.insert(parts.end(), plane.begin(), plane.end());
  reopenNarrowGaps(l, liquid_distance, solids.fluid, parts);
  return giveToBodies(grid, bodies, liquid_distance, parts, solids);
}

std::vector<Matrix6d> closeThinWalls(const MacGrid& grid, const std::vector<RigidBody>& bodies,
                                     const std::vector<double>& liquid_distance, SolidFractions& solids) {
  const auto mayBeThin = [&](const RigidBody& body) { return body.thinnest < kThinWall * grid.h; };
  if (std::none_of(bodies.begin(), bodies.end(), mayBeThin))
    return std::vector<Matrix6d>(bodies.size(), Matrix6d::Zero());
  const Lattice& l = grid.lattice;
  std::vector<Eigen::Isometry3d> X_BW;
  for (const RigidBody& body : bodies) X_BW.push_back(body.pose().inverse());
  std::vector<std::vector<StickingPart>> found(l.faceEnd(2));  // by plane
  forEachHeavyRow(l, [&](std::ptrdiff_t row, int j, int k) {
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const auto f = row + i;
        const int owner = solids.owner[a][f];
        double& fluid = solids.fluid[a][f];
        if (!(fluid > 0.0) || solids.distance[a][f] > 0.0F || owner < 0 || !mayBeThin(bodies[owner])) continue;
        const Eigen::Vector3d x = grid.faceCenter(a, i, j, k);
        const Eigen::Vector3d image = x + toImageAt(bodies[owner], grid, x);
        if (!isThinner(*bodies[owner].distance, X_BW[owner] * image, kThroughCorner * kThinWall * grid.h)) continue;
        found[k].push_back({a, f, owner, fluid});
        fluid = 0.0;
      }
    }
  });
  std::vector<StickingPart> parts;
  for (const auto& plane : found) parts.insert(parts.end(), plane.begin(), plane.end());
  return giveToBodies(grid, bodies, liquid_distance, parts, solids);
}

}  // namespace monolith
