#pragma once
// What the viscous samples of a grid are made of: the kinds of all faces, found once for each, and the segments between
// them.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "coupling/fitted_segment.h"
#include "coupling/stokes_coefficients.h"

namespace monolith {

// Of rows that are steady, and between such, what is there is kept. May be null.
void findFaceKinds(const Lattice& lattice, const StokesGeometry& geometry,
                   const StaggeredCoefficients<double>& coefficients, const SteadyRows* steady, FaceKinds& kinds);

// Liquid part of a cube of width one from the distance at its centre.
inline double liquidOfCube(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

class SampleBuilder {
 public:
  SampleBuilder(const Lattice& l, const StokesGeometry& g, const FaceKinds& kinds)
      : lattice(l), geometry(g), kinds_(kinds) {}

  FaceKind kind(int axis, std::ptrdiff_t f) const { return kinds_[axis][f]; }
  const FaceKind* kinds(int axis) const { return kinds_[axis].data(); }
  // Of component `axis`, from face a to the next along `along`.
  FittedSegment segment(int axis, std::ptrdiff_t a, int along) const {
    const auto b = a + lattice.stride[along];
    const auto& distance = (*geometry.solid_distance)[axis];
    const FaceKind kind_a = kind(axis, a), kind_b = kind(axis, b);
    const bool cut = isSolid(kind_a) != isSolid(kind_b);
    return fitSegment(kind_a, distance[a], kind_b, distance[b], cut ? sag(axis, a, along) : 0.0);
  }
  double liquidOfCell(std::ptrdiff_t c) const { return liquidOfCube((*geometry.liquid_distance)[c]); }
  double liquidOfEdge(std::ptrdiff_t c, int a, int b) const {
    const auto& d = *geometry.liquid_distance;
    const auto sa = lattice.stride[a];
    const auto sb = lattice.stride[b];
    return liquidOfCube(0.25 * (d[c] + d[c - sa] + d[c - sb] + d[c - sa - sb]));
  }
  // What a row of cells is like: plain if none of the faces that the samples of a cell join is in a solid or cut by
  // one; still if all are solid or in the air, where the samples are nothing.
  enum Mark : std::uint8_t { kPlain, kMixed, kStill };
  void markCells(std::ptrdiff_t row, int width, std::vector<std::uint8_t>& mark) const;

  const Lattice& lattice;
  const StokesGeometry& geometry;

 private:
  // By how much the solids' distance half way along a segment lies below the mean of its ends'.
  double sag(int axis, std::ptrdiff_t a, int along) const {
    if (geometry.solid_cell_distance == nullptr) return 0.0;
    const auto& cell = *geometry.solid_cell_distance;
    const auto& distance = *geometry.solid_distance;
    const auto b = a + lattice.stride[along];
    const auto sum = [](double x, double y) { return x + y; };  // in double precision
    const double mean = 0.5 * sum(distance[axis][a], distance[axis][b]);
    if (axis == along) return mean - cell[a];
    // Half way is an edge. The faces of the other component there, minus the cells around: what is left of the second
    // derivatives is that of the segment itself.
    const auto low = b - lattice.stride[axis];
    return 0.25 * (sum(cell[a], cell[b]) + sum(cell[low], cell[low - lattice.stride[along]])) -
           0.5 * sum(distance[along][low], distance[along][b]);
  }

  const FaceKinds& kinds_;
};

}  // namespace monolith
