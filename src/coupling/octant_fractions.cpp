#include "coupling/octant_fractions.h"

#include <cmath>

#include "geometry/cube_fraction.h"

namespace monolith {
namespace {

// Half the diagonal of a cube of width one, and a little more: a surface farther from its centre does not cut it.
constexpr double kHalfDiagonal = 0.8662;

}  // namespace

void octantFractions(const SignedDistance& solid, const Eigen::Vector3d& center, const Eigen::Matrix3d& R_WB,
                     double width, Octants& out) {
  std::array<Eigen::Vector3d, 8> corner;  // of a cube of half width one, in the solid's frame
  for (int o = 0; o < 8; ++o) {
    corner[o] = R_WB.transpose() * Eigen::Vector3d((o & 1) ? 1 : -1, (o & 2) ? 1 : -1, (o & 4) ? 1 : -1);
  }
  CutCubes cubes;
  for (int o = 0; o < 8; ++o) {
    const Eigen::Vector3d octant = center + 0.25 * width * corner[o];
    const double distance = solid.distance(octant);
    if (std::abs(distance) > kHalfDiagonal * 0.5 * width) {
      out[o] = distance < 0.0 ? 1.0 : 0.0;
      continue;
    }
    std::array<bool, 8> cut, inside;
    for (int q = 0; q < 8; ++q) {
      const DistanceSample s = solid.sample(octant + 0.125 * width * corner[q]);
      cut[q] = !(std::abs(s.distance) > kHalfDiagonal * 0.25 * width);
      inside[q] = s.distance < 0.0;
      if (cut[q]) cubes.set(q, s.distance, R_WB * s.gradient);
    }
    insideFractions(cubes, 0.25 * width);
    double sum = 0.0;
    for (int q = 0; q < 8; ++q) sum += cut[q] ? cubes.inside[q] : inside[q] ? 1.0 : 0.0;
    out[o] = 0.125 * sum;
  }
}

}  // namespace monolith
