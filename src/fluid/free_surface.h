#pragma once
// The liquid's surface as a level set: signed distance in cell widths at cell centres, negative in the liquid, moved by the
// velocity and kept a distance by fast sweeping (Zhao 2005, Math. Comput. 74, 603).
//
// Volume: the level set is shifted, by a fraction of a percent of a cell, to the volume that the liquid has had from the
// start; how much is reported. What detaches below the grid's resolution thus returns to the pool.
// In solids the level set is continued along their normals: the surface meets them at 90 degrees.

#include <vector>

#include "fluid/mac_grid.h"
#include "solve/staggered_operator.h"

namespace monolith {

class FreeSurface {
 public:
  // Liquid below `fill_height` (m above the tank's floor) and in boxes (W).
  FreeSurface(const MacGrid& grid, double fill_height, const std::vector<Eigen::AlignedBox3d>& boxes);

  // Neither air in the tank nor, for `empty`, liquid.
  bool full() const { return full_; }
  bool empty() const { return empty_; }

  // Cell widths, halo filled.
  const std::vector<double>& distance() const { return distance_; }

  // The surface moves with the liquid over dt.
  void advect(const FaceField<double>& velocity, double dt, double maximum_speed);

  // Continues the distance into solids. solid_distance in cell widths, cell centres.
  void extendIntoSolids(const std::vector<double>& solid_distance);

  // Liquid volume, m^3; cell_fluid: part of each cell that is not solid.
  double volume(const std::vector<double>& cell_fluid) const;

  // Shifts the surface until volume() is `target`; returns the volume added, m^3.
  double correctVolume(double target, const std::vector<double>& cell_fluid);

  // Unit normal out of the liquid, at a cell.
  Eigen::Vector3d normal(std::ptrdiff_t cell) const;

 private:
  void redistance();
  double shiftedVolume(double shift, const std::vector<double>& cell_fluid) const;

  MacGrid grid_;
  bool full_ = false;
  bool empty_ = false;
  double travelled_ = 0.0;  // cells, since the distance was last made one
  std::vector<double> distance_;
  std::vector<double> scratch_;
};

}  // namespace monolith
