#pragma once
// Part of a cube that lies inside a solid, from the distance and gradient at its centre: the surface is taken as the
// plane through the nearest surface point (Scardovelli & Zaleski 2000, J. Comput. Phys. 164, 228). Error of second
// order in width times curvature.

#include <Eigen/Dense>
#include <array>

namespace monolith {

// 0: all outside, 1: all inside. `gradient` need not be of unit length; `distance` and `width` in m.
double insideFraction(double distance, const Eigen::Vector3d& gradient, double width);

// The same of eight cubes at once; of those that are not set nothing is told.
struct CutCubes {
  static constexpr int kCount = 8;

  std::array<double, kCount> distance{}, length{};
  std::array<std::array<double, kCount>, 3> gradient{};  // by component
  std::array<double, kCount> inside{};                   // part of each: the result

  void set(int i, double of_centre, const Eigen::Vector3d& slope) {
    distance[i] = of_centre;
    length[i] = slope.norm();
    for (int a = 0; a < 3; ++a) gradient[a][i] = slope[a];
  }
};
void insideFractions(CutCubes& cubes, double width);

}  // namespace monolith
