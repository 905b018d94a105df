#pragma once
// The liquid's surface as a level set: signed distance in cell widths at cell centres, negative in the liquid, moved by
// the velocity and kept a distance, in a band around the surface, by Gauss-Seidel on the upwind eikonal equation (Zhao
// 2005, Math. Comput. 74, 603), its cells in two colours.
//
// Volume: the level set is shifted, by a fraction of a percent of a cell, to the volume that the liquid has had from
// the start; how much is reported. Pools that are not connected keep their own volume each; what detaches below the
// grid's resolution returns to the nearest.
//
// In solids the level set is continued from the liquid or the air next to them. What lies on the two sides of a wall
// has nothing to do with each other: where its sign changes within a solid there is no surface.

#include <vector>

#include "fluid/filled_boxes.h"
#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

class FreeSurface {
 public:
  // Liquid below `fill_height` (m above the tank's floor) and in boxes (W), see FilledBoxes. At edges and corners of
  // boxes the distance is not that from them but what makes volume() theirs; beside solids it is left as it is.
  FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes,
              const SolidDistance& solid_distance = nullptr);

  FreeSurface(const FreeSurface&) = default;
  FreeSurface& operator=(const FreeSurface& other);

  // Neither air in the tank nor, for `empty`, liquid.
  bool full() const { return full_; }
  bool empty() const { return empty_; }

  // Cell widths, halo filled.
  const std::vector<double>& distance() const { return distance_; }

  // The surface moves with the liquid over dt. solid_distance as below; empty: there are no solids.
  void advect(const FaceField<double>& velocity, double dt, double maximum_speed,
              const std::vector<float>& solid_distance);

  // Continues the distance into solids with the slope that it has next to them: liquid without surface tension has no
  // angle at which it meets a solid, and at rest it stays so. Distances from solids in cell widths, at cell centres and
  // at faces, whose differences tell the nearer side of a wall two cells thick.
  void extendIntoSolids(const std::vector<float>& solid_distance, const FaceField<float>& at_faces);

  // Liquid volume, m^3; cell_fluid: part of each cell that is not solid.
  double volume(const std::vector<double>& cell_fluid) const;

  // Shifts the surface until volume() is `target`; returns the volume added, m^3. open: part of each face that is not
  // solid.
  double correctVolume(double target, const std::vector<double>& cell_fluid, const FaceField<double>& open);

  // Unit normal out of the liquid, at a cell.
  Eigen::Vector3d normal(std::ptrdiff_t cell) const;

 private:
  struct CutCell {
    double distance = 0.0;
    double fluid = 0.0;
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    int pool = 0;
  };
  // full, sum: cells, by pool: of those that lie in the liquid, and with what the surface cuts.
  struct CutPlane {
    std::vector<CutCell> cells;
    std::vector<double> full, sum;
  };
  using CutCells = std::vector<CutPlane>;
  // of: the pool that a cell belongs to, or -1; empty where there is but one.
  struct Pools {
    int count = 1;
    std::vector<std::int32_t> of;
    std::vector<double> volume;  // m^3, that they ought to have
  };
  // Room to work in; a copy has its own.
  struct Scratch {
    Scratch() = default;
    Scratch(const Scratch&) {}
    Scratch& operator=(const Scratch&) = delete;
    std::vector<double> field;
    std::vector<std::uint8_t> nearness;
  };

  void fitToParts(const FilledBoxes& liquid, const SolidDistance& solid_distance);
  // Of the distance, over two cells.
  Eigen::Vector3d slopeAt(std::ptrdiff_t cell) const {
    Eigen::Vector3d slope;
    for (int a = 0; a < 3; ++a) {
      const std::ptrdiff_t next = grid_.lattice.stride[a];
      slope[a] = distance_[cell + next] - distance_[cell - next];
    }
    return slope;
  }
  static double partInLiquid(double distance, const Eigen::Vector3d& slope);  // of a cell
  void redistance(const std::vector<float>& solid_distance);
  Pools findPools(const std::vector<double>& cell_fluid, const FaceField<double>& open) const;
  CutCells findCutCells(double margin, const std::vector<double>& cell_fluid, const Pools& pools) const;
  std::vector<int> groupPools(const Pools& now, std::vector<double>& known) const;
  // m^3, of each pool, with a shift for each.
  Eigen::VectorXd shiftedVolumes(const Eigen::VectorXd& shifts, CutCells& cut) const;

  MacGrid grid_;
  bool full_ = false;
  bool empty_ = false;
  double travelled_ = 0.0;  // cells, since the distance was last made one
  std::vector<double> distance_;
  Pools pools_;  // of the last correction
  Scratch scratch_;
};

}  // namespace monolith
