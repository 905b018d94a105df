#include "simulation/velocity_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/marked_entries.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// A face whose centre is solid and that has less of liquid.
constexpr double kSliver = 0.25;
// A face that the surface cuts may be faster than those around it by as many times its liquid part, if that is more
// than one: what is heavy is not driven by next to nothing. With less, cavities close with less of a jet; with more, or
// with faces that are not whole for those around, energy comes of nothing where sub-steps are short.
constexpr double kOfPart = 2.0;
constexpr float kNextToBody = 1.5F;  // cells

void fillHalos(const Lattice& l, FaceField<double>& velocity, FaceMask& known) {
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, velocity[a]);
    fillHalo(l, known[a]);
  }
}

}  // namespace

void limitSlivers(const SolidFractions& solids, const MacGrid& grid, FaceField<double>& velocity, FaceMask& known) {
  const Lattice& l = grid.lattice;
  const std::vector<std::uint8_t> near_body = rowsOfBodies(l, solids.bodies);
  fillHalos(l, velocity, known);
  for (int a = 0; a < 3; ++a) {
    const auto isSliver = [&](std::ptrdiff_t f) {
      return solids.distance[a][f] <= 0.0F && solids.fluid[a][f] > 0.0 && solids.fluid[a][f] < kSliver;
    };
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      if (!near_body[j + static_cast<std::size_t>(l.faceEnd(1)) * k]) return;
      for (auto f = row; f < row + l.faceEnd(0); ++f) {
        if (!known[a][f] || !isSliver(f)) continue;
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (int b = 0; b < 3; ++b) {
          for (const auto next : {f - l.stride[b], f + l.stride[b]}) {
            if (!known[a][next] || isSliver(next)) continue;
            least = std::min(least, velocity[a][next]);
            most = std::max(most, velocity[a][next]);
          }
        }
        if (!(least <= most)) continue;
        const double room = most - least + std::max(std::abs(least), std::abs(most));
        velocity[a][f] = std::clamp(velocity[a][f], least - room, most + room);
      }
    });
  }
}

void limitCutFaces(const FaceField<double>& liquid_mass, const SolidFractions& solids, const MacGrid& grid,
                   const std::vector<double>& body_speeds, double slack, FaceField<double>& velocity, FaceMask& known) {
  const Lattice& l = grid.lattice;
  fillHalos(l, velocity, known);
  const auto isCut = [&](int a, std::ptrdiff_t f) { return liquid_mass[a][f] < solids.fluid[a][f]; };
  const auto isWhole = [&](int a, std::ptrdiff_t f) { return known[a][f] != 0 && !isCut(a, f); };
  const auto markCut = [&](int a, std::ptrdiff_t row, RowMarks& marks) {
    std::uint8_t* cut = marks.start(l.faceEnd(0));
    const std::uint8_t* has = known[a].data() + row;
    const double *mass = liquid_mass[a].data() + row, *fluid = solids.fluid[a].data() + row;
#pragma omp simd
    for (int i = 0; i < l.faceEnd(0); ++i) cut[i] = (has[i] != 0) & (mass[i] < fluid[i]);
  };
  for (int a = 0; a < 3; ++a) {
    std::vector<double>& u = velocity[a];
    // Only whole faces are read, and only cut ones written.
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      thread_local RowMarks marks;
      markCut(a, row, marks);
      marks.forEach([&](std::ptrdiff_t i) {
        const auto f = row + i;
        double most = -1.0;
        const auto look = [&](int b, std::ptrdiff_t face) {
          if (isWhole(b, face)) most = std::max(most, std::abs(velocity[b][face]));
        };
        for (int b = 0; b < 3; ++b) {
          for (const auto step : {-l.stride[b], l.stride[b]}) {
            const auto near = f + step, far = near + step;
            look(a, near);
            if (isWhole(a, near) && isWhole(a, far)) most = std::max(most, std::abs(2.0 * u[near] - u[far]));
            if (b == a) continue;
            const auto end = std::max<std::ptrdiff_t>(step, 0);
            look(b, f + end);
            look(b, f + end - l.stride[a]);
          }
        }
        if (most < 0.0) return;
        const int owner = solids.owner[a][f];
        if (owner >= 0 && solids.distance[a][f] < kNextToBody) most = std::max(most, body_speeds[owner]);
        const double part = liquid_mass[a][f] / solids.fluid[a][f];
        const double limit = std::max(1.0, kOfPart * part) * most + slack;
        u[f] = std::clamp(u[f], -limit, limit);
      });
    });
  }
}

}  // namespace monolith
