#pragma once
// What the viscous samples of a grid are made of: the kinds of all faces, found once for each, and the segments between
// them.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "coupling/fitted_segment.h"
#include "coupling/stokes_coefficients.h"

namespace monolith {

using FaceKinds = std::array<std::vector<FaceKind>, 3>;

FaceKinds findFaceKinds(const Lattice& lattice, const StokesGeometry& geometry,
                        const StaggeredCoefficients<double>& coefficients);

// Liquid part of a cube of width one from the distance at its centre.
inline double liquidOfCube(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

class SampleBuilder {
 public:
  SampleBuilder(const Lattice& l, const StokesGeometry& g, const StaggeredCoefficients<double>& c)
      : lattice(l), geometry(g), kinds_(findFaceKinds(l, g, c)) {}

  FaceKind kind(int axis, std::ptrdiff_t f) const { return kinds_[axis][f]; }
  FittedSegment segment(int axis, std::ptrdiff_t a, std::ptrdiff_t b) const {
    const auto& distance = (*geometry.solid_distance)[axis];
    return fitSegment(kind(axis, a), distance[a], kind(axis, b), distance[b]);
  }
  double liquidOfCell(std::ptrdiff_t c) const { return liquidOfCube((*geometry.liquid_distance)[c]); }
  double liquidOfEdge(std::ptrdiff_t c, int a, int b) const {
    const auto& d = *geometry.liquid_distance;
    const auto sa = lattice.stride[a];
    const auto sb = lattice.stride[b];
    return liquidOfCube(0.25 * (d[c] + d[c - sa] + d[c - sb] + d[c - sa - sb]));
  }
  // What a row of cells is like: plain if all faces that the samples of a cell join are in the liquid, far from any
  // surface of a solid; air if all are in the air, where there are no samples.
  enum Mark : std::uint8_t { kPlain, kMixed, kAllAir };
  void markCells(std::ptrdiff_t row, int width, std::vector<std::uint8_t>& mark) const;

  const Lattice& lattice;
  const StokesGeometry& geometry;

 private:
  FaceKinds kinds_;
};

}  // namespace monolith
