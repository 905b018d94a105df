#include "coupling/displaced_moments.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace monolith {
namespace {

using Vector4d = Eigen::Vector4d;

// A body that is hardly larger than a cell is no better known than its few faces tell.
constexpr double kLargestChange = 0.5;
constexpr double kLeastPivot = 1e-6;

struct CutFace {
  std::size_t place;  // in the box
  Vector4d moments;   // 1 and its place, cells from the body's centre
};

// Of the faces of one axis.
struct Moments {
  Vector4d sum = Vector4d::Zero();
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();  // weighted W (1 - W)
  std::vector<CutFace> cut;
};

Moments momentsOfPlane(const MacGrid& grid, const BodyFractions& f, int axis, int k, const Eigen::Vector3d& centre) {
  Moments out;
  for (int j = 0; j < f.count[1]; ++j) {
    for (int i = 0; i < f.count[0]; ++i) {
      const std::size_t place = f.local(i, j, k);
      const double part = f.face[axis][place];
      if (part == 0.0) continue;
      Vector4d moments;
      moments << 1.0, (grid.faceCenter(axis, f.low[0] + i, f.low[1] + j, f.low[2] + k) - centre) / grid.h;
      out.sum += part * moments;
      if (part == 1.0) continue;
      out.gram += part * (1.0 - part) * moments * moments.transpose();
      out.cut.push_back({place, moments});
    }
  }
  return out;
}

}  // namespace

void fitMoments(const MacGrid& grid, const Displacement& displaced, BodyFractions& f) {
  // One sum per plane, added in order: the same bits at any thread count.
  std::vector<Moments> planes(3 * f.count[2]);
#pragma omp parallel for schedule(dynamic) if (f.cell.size() >= kSizeWorthSharing)
  for (int at = 0; at < 3 * f.count[2]; ++at) {
    planes[at] = momentsOfPlane(grid, f, at / f.count[2], at % f.count[2], displaced.centre);
  }
  for (int a = 0; a < 3; ++a) {
    const auto first = planes.begin() + a * f.count[2], end = first + f.count[2];
    Vector4d missing = displaced.volume / grid.cellVolume() * Vector4d::Unit(0);
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    for (auto plane = first; plane != end; ++plane) {
      missing -= plane->sum;
      gram += plane->gram;
    }
    // Of least norm where the cut faces cannot tell, as of a box along the grid.
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d> solver;
    solver.setThreshold(kLeastPivot);
    Vector4d change = solver.compute(gram).solve(missing);
    double largest = 0.0;
    for (auto plane = first; plane != end; ++plane) {
      for (const CutFace& face : plane->cut) largest = std::max(largest, std::abs(change.dot(face.moments)));
    }
    if (largest > kLargestChange) change *= kLargestChange / largest;
    for (auto plane = first; plane != end; ++plane) {
      for (const CutFace& face : plane->cut) {
        double& part = f.face[a][face.place];
        part += part * (1.0 - part) * change.dot(face.moments);
      }
    }
  }
}

}  // namespace monolith
