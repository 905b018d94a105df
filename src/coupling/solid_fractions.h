#pragma once
// Where the solids are on the grid, W_F^u and W_Si^u: for each face the part of its control volume, a cube of width h
// about its centre, that each body, the wall and the liquid's side take; sum_i W_Si + W_wall + W_F = 1 exactly, also
// where bodies touch or overlap. And the signed distance at face centres, which the fitted boundary
// (stokes_coefficients.h) needs.
//
// Bodies are sampled by quarter cells, each cut by a plane, so W is exact for planes and of second order for curved
// surfaces, and it changes smoothly when a body moves through the grid. Then they are fitted to the body's volume and
// its centre (displaced_moments.h), where all of the body lies in the tank.

#include <array>
#include <cstdint>
#include <vector>

#include "fluid/mac_grid.h"
#include "rigid/rigid_body.h"
#include "solve/staggered_operator.h"

namespace monolith {

// The part of a body in the half of a wall face's control volume that lies in the tank. The face is the wall's, so
// it is no part of W_Si.
struct WallPart {
  int axis = 0;
  std::ptrdiff_t face = 0;
  std::ptrdiff_t cell = 0;  // next to it, in the tank
  double fraction = 0.0;    // of the whole control volume
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

// Fractions of one body on the faces of a box of cells; outside the box they are zero.
struct BodyFractions {
  std::array<int, 3> low{};    // first cell of the box; may lie in a periodic image
  std::array<int, 3> count{};  // cells along each axis
  std::array<bool, 3> endless{};  // a periodic axis that the body spans: the box is one period and closes on itself
  FaceField<double> face;      // W_Si per axis, box-local index
  std::vector<double> cell;    // part of the cell
  std::vector<WallPart> at_walls;

  // Place along an axis, which may be just outside the box; -1: there is nothing.
  int within(int axis, int at) const {
    if (endless[axis]) return (at + count[axis]) % count[axis];
    return at < count[axis] ? at : -1;
  }
  std::size_t local(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(count[0]) * (static_cast<std::size_t>(j) + static_cast<std::size_t>(count[1]) * k);
  }
};

struct SolidFractions {
  static constexpr std::int16_t kWall = -1;
  // Cell widths. Away from a body its distance is not known, only that it is large; no more is told, or averages next
  // to the body, of which coarser levels are made, would go wrong.
  static constexpr float kFarthest = 2.5f;

  FaceField<double> fluid;                          // W_F on faces
  FaceField<float> distance;                        // in cell widths, at face centres; <= 0 in solid, at most kFarthest
  std::array<std::vector<std::int16_t>, 3> owner;   // whose distance that is: a body or kWall
  std::vector<float> cell_distance;                 // in cell widths, of bodies and walls at cell centres
  std::vector<double> cell_fluid;                   // part of the cell that is not solid
  std::vector<BodyFractions> bodies;
};

// 1 for the x-rows of faces, j fastest, that the box of a body holds: in others there are the tank's walls alone.
std::vector<std::uint8_t> rowsOfBodies(const Lattice& lattice, const std::vector<BodyFractions>& bodies);

class SolidSampler {
 public:
  explicit SolidSampler(const MacGrid& grid) : grid_(grid) {}
  // A body that has hardly moved since it was sampled is not sampled again.
  void sample(const std::vector<RigidBody>& bodies, SolidFractions& out);
  // What was sampled before does not count from now on.
  void forget() { samples_.clear(); }

 private:
  // One body by itself, as if nothing else were there; fields are box-local.
  struct BodySample {
    const SignedDistance* shape = nullptr;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    BodyFractions fractions;
    FaceField<float> distance;         // in cell widths, at face centres
    std::vector<float> cell_distance;  // at cell centres
  };

  // Solid part of the low and high half of a cell along each axis.
  using CellHalves = std::array<float, 6>;

  bool serves(const BodySample& sample, const RigidBody& body) const;
  void sampleBody(const RigidBody& body, BodySample& out) const;
  // Cells around a box in W, in which there is the body; returns whether all of it is.
  bool placeBox(const Eigen::AlignedBox3d& box, BodyFractions& out) const;
  void sampleCells(const SignedDistance& shape, const Eigen::Isometry3d& X_BW, const Eigen::Matrix3d& R_WB,
                   BodySample& out, std::vector<CellHalves>& halves) const;
  // A face's control volume is made of the halves on both sides.
  static void joinHalves(const std::vector<CellHalves>& halves, BodyFractions& out);
  void addBody(const BodySample& sample, int index, SolidFractions& out) const;
  void close(SolidFractions& out) const;

  MacGrid grid_;
  std::vector<BodySample> samples_;
};

}  // namespace monolith
