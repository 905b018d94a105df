// How the liquid's motion goes on into the air.

#include "simulation/continued_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "solve/lattice.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr int kCells = 16;
constexpr int kReach = 2;  // faces above the surface
constexpr double kAnySlope = 1e9;

MacGrid grid() {
  MacGrid grid;
  grid.lattice = Lattice({kCells, kCells, kCells}, {false, false, false});
  grid.h = 0.1;
  grid.origin = Vector3d(-0.8, -0.8, -0.8);
  return grid;
}

SolidFractions onlyWalls(const MacGrid& grid) {
  SolidFractions solids;
  SolidSampler sampler(grid);
  sampler.sample({}, solids);
  return solids;
}

// No divergence, no vorticity, and none through the walls x = -0.8: potential of (x + 0.8)^3 - 3 (x + 0.8) z^2.
Vector3d potentialFlow(const Vector3d& point) {
  const double x = point[0] + 0.8, z = point[2];
  return {3.0 * (x * x - z * z), 0.0, -6.0 * x * z};
}

// Largest error of the faces up to kReach above a surface of slope `tilt` (cells a cell along x) after they were
// continued, of the largest velocity; faces at whose sides the flow goes through walls do not count.
double errorAbove(const std::function<Vector3d(const Vector3d&)>& flow, double tilt) {
  const MacGrid g = grid();
  const Lattice& l = g.lattice;
  const SolidFractions solids = onlyWalls(g);
  const auto top = [&](double x) { return 0.3 * g.h + tilt * x; };
  FaceField<double> velocity;
  FaceMask known;
  for (int a = 0; a < 3; ++a) {
    velocity[a].assign(l.size, 0.0);
    known[a].assign(l.size, 0);
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      for (int i = 0; i < l.faceEnd(0); ++i) {
        const Vector3d x = g.faceCenter(a, i, j, k);
        if (!(solids.distance[a][row + i] > 0.0F) || x[2] > top(x[0])) continue;
        velocity[a][row + i] = flow(x)[a];
        known[a][row + i] = 1;
      }
    });
  }
  const LiquidField field{&velocity, nullptr, kAnySlope};
  FaceMask work;
  completeMotion(solids, g, {}, kReach + 1, false, false, {field}, known, work);
  double error = 0.0, largest = 0.0;
  int looked_at = 0;
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < l.faceEnd(0) - 5; ++i) {
        const Vector3d x = g.faceCenter(a, i, j, k);
        const bool above = x[2] > top(x[0]) && x[2] < top(x[0]) + kReach * g.h;
        if (!above || !(solids.distance[a][row + i] > 0.0F)) continue;
        error = std::max(error, std::abs(velocity[a][row + i] - flow(x)[a]));
        largest = std::max(largest, flow(x).norm());
        ++looked_at;
      }
    }
  });
  EXPECT_GT(looked_at, 800);
  return error / largest;
}

TEST(ContinuedMotion, APotentialFlowGoesOnExactly) { EXPECT_LT(errorAbove(potentialFlow, 0.0), 1e-12); }

// At a slant the steps of the surface leave some faces to the slope of their own component.
TEST(ContinuedMotion, AndNearlySoAtASlant) { EXPECT_LT(errorAbove(potentialFlow, 0.4), 0.05); }

// So does one whose vorticity is the same everywhere.
TEST(ContinuedMotion, ALiquidThatTurnsAsAWholeGoesOnExactly) {
  const auto turning = [](const Vector3d& point) -> Vector3d {
    return Vector3d(0.3, 1.0, -0.5).cross(point - Vector3d(0.1, 0.2, -0.3));
  };
  EXPECT_LT(errorAbove(turning, 0.0), 1e-12);
  EXPECT_LT(errorAbove(turning, 0.4), 1e-12);
}

}  // namespace
}  // namespace monolith
