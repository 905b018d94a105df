#include "coupling/displaced_moments.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

// A body that is hardly larger than a cell is no better known than its few faces tell.
constexpr double kLargestChange = 0.5;
constexpr double kLeastPivot = 1e-6;

}  // namespace

void fitMoments(const MacGrid& grid, const Displacement& displaced, BodyFractions& f) {
  using Vector4d = Eigen::Vector4d;
  for (int a = 0; a < 3; ++a) {
    const auto forEachPart = [&](auto&& function) {
      for (int k = 0; k < f.count[2]; ++k) {
        for (int j = 0; j < f.count[1]; ++j) {
          for (int i = 0; i < f.count[0]; ++i) {
            double& part = f.face[a][f.local(i, j, k)];
            if (part == 0.0) continue;
            const Eigen::Vector3d x = grid.faceCenter(a, f.low[0] + i, f.low[1] + j, f.low[2] + k);
            Vector4d moments;
            moments << 1.0, (x - displaced.centre) / grid.h;
            function(part, moments);
          }
        }
      }
    };
    Vector4d wanted = Vector4d::Zero();
    wanted[0] = displaced.volume / grid.cellVolume();
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    forEachPart([&](double part, const Vector4d& moments) {
      wanted -= part * moments;
      gram += part * (1.0 - part) * moments * moments.transpose();
    });
    // Of least norm where the cut faces cannot tell, as of a box along the grid.
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d> solver;
    solver.setThreshold(kLeastPivot);
    const Vector4d change = solver.compute(gram).solve(wanted);
    double largest = 0.0;
    forEachPart([&](double part, const Vector4d& moments) {
      if (part < 1.0) largest = std::max(largest, std::abs(change.dot(moments)));
    });
    const double scale = largest > kLargestChange ? kLargestChange / largest : 1.0;
    forEachPart(
        [&](double& part, const Vector4d& moments) { part += scale * part * (1.0 - part) * change.dot(moments); });
  }
}

}  // namespace monolith
