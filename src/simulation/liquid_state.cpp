#include "simulation/liquid_state.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fluid/advection.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr double kLeastSlope = 0.25;      // of the level set, per cell
constexpr float kWhollySolid = -0.4999F;  // cells: a wall that covers a cell reaches so far beyond its centre

template <class Real>
Eigen::Vector3d slopeOf(const Lattice& l, const std::vector<Real>& field, std::ptrdiff_t c) {
  Eigen::Vector3d slope;
  for (int a = 0; a < 3; ++a) slope[a] = 0.5 * (field[c + l.stride[a]] - field[c - l.stride[a]]);
  return slope;
}

}  // namespace

MacGrid makeGrid(const TankDescription& tank, const LiquidDescription& liquid) {
  const bool dry = !liquid.any();
  MacGrid grid;
  std::array<int, 3> n;
  for (int a = 0; a < 3; ++a) n[a] = dry ? 1 : static_cast<int>(std::lround(tank.size[a] / tank.cell_width));
  grid.lattice = Lattice(n, {tank.periodic[0], tank.periodic[1], tank.periodic[2]});
  grid.h = tank.cell_width;
  grid.origin = tank.origin;
  return grid;
}

void setVelocity(const MacGrid& grid, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity,
                 FaceField<double>& faces) {
  const Lattice& l = grid.lattice;
  for (int a = 0; a < 3; ++a) {
    faces[a].assign(l.size, 0.0);
    for (int k = 0; k < l.faceEnd(2); ++k) {
      for (int j = 0; j < l.faceEnd(1); ++j) {
        for (int i = 0; i < l.faceEnd(0); ++i) {
          const Eigen::Vector3d u = velocity(grid.faceCenter(a, i, j, k));
          if (!u.allFinite()) throw std::invalid_argument("velocity of the liquid: expected finite numbers");
          faces[a][l.index(i, j, k)] = u[a];
        }
      }
    }
    fillHalo(l, faces[a]);
  }
}

// Of any rigid motion v + w x (x - centre) exactly: the mean of both ends of each axis, and half of the curl.
Vector6d rigidMotion(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity,
                     const Eigen::Vector3d& centre, double radius) {
  Vector6d twist = Vector6d::Zero();
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(a);
    const Eigen::Vector3d high = velocity(centre + radius * axis), low = velocity(centre - radius * axis);
    twist.head<3>() += (high + low) / 6.0;
    twist.tail<3>() += axis.cross(high - low) / (4.0 * radius);
  }
  return twist;
}

double largestSpeed(const FaceField<double>& velocity) {
  double sum = 0.0;
  for (const auto& field : velocity) {
    double largest = 0.0;
#pragma omp parallel for simd schedule(static) reduction(max : largest)
    for (std::size_t i = 0; i < field.size(); ++i) largest = std::max(largest, std::abs(field[i]));
    sum += largest * largest;
  }
  return std::sqrt(sum);
}

void markResolved(const StepProblem& problem, FaceMask& mask) {
  const Lattice& l = problem.grid.lattice;
  for (int a = 0; a < 3; ++a) {
    assignZero(l.size, mask[a]);
    forEachRow(l,
               [&](std::ptrdiff_t row, int, int) { problem.markResolved(a, row, l.faceEnd(0), mask[a].data() + row); });
  }
}

bool intersect(const FaceMask& mask, const FaceMask& other, FaceMask& both) {
  int lost = 0;
  for (int a = 0; a < 3; ++a) {
    const std::size_t size = mask[a].size();
    both[a].resize(size);
    const std::uint8_t *x = mask[a].data(), *y = other[a].data();
    std::uint8_t* out = both[a].data();
#pragma omp parallel for simd schedule(static) reduction(| : lost)
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = x[i] & y[i];
      lost |= x[i] & ~y[i];
    }
  }
  return lost != 0;
}

std::vector<double> hydrostaticPressure(const MacGrid& grid, const FreeSurface& surface, double density,
                                        const Eigen::Vector3d& gravity) {
  const Lattice& l = grid.lattice;
  std::vector<double> pressure(l.size, 0.0);
  const auto& d = surface.distance();
  // The highest point of the liquid along gravity, where the pressure is zero.
  double least = 0.0;
  bool found = false;
  const auto visit = [&](auto&& f) {
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) f(l.index(i, j, k), gravity.dot(grid.cellCenter(i, j, k)));
      }
    }
  };
  visit([&](std::ptrdiff_t c, double depth) {
    if (d[c] >= 0.0 || d[c] < -1.0) return;
    const double top = depth + d[c] * grid.h * gravity.norm();
    least = found ? std::min(least, top) : top;
    found = true;
  });
  visit([&](std::ptrdiff_t c, double depth) {
    if (d[c] < 0.0) pressure[c] = density * (depth - least);
  });
  return pressure;
}

LiquidMotion liquidMotion(const MacGrid& grid, const FaceField<double>& liquid_mass, const FaceField<double>& velocity,
                          double density) {
  const Lattice& l = grid.lattice;
  // One sum per plane, added in order: the same bits at any thread count.
  std::vector<LiquidMotion> planes(l.faceEnd(2));
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.faceEnd(2); ++k) {
    LiquidMotion& plane = planes[k];
    for (int j = 0; j < l.faceEnd(1); ++j) {
      const auto row = l.index(0, j, k);
      for (int a = 0; a < 3; ++a) {
        const double *mass = liquid_mass[a].data() + row, *u = velocity[a].data() + row;
        double momentum = 0.0, energy = 0.0;
#pragma omp simd reduction(+ : momentum, energy)
        for (int i = 0; i < l.faceEnd(0); ++i) {
          momentum += mass[i] * u[i];
          energy += 0.5 * mass[i] * u[i] * u[i];
        }
        plane.momentum[a] += momentum;
        plane.energy += energy;
      }
    }
  }
  LiquidMotion motion;
  for (const LiquidMotion& plane : planes) {
    motion.energy += plane.energy;
    motion.momentum += plane.momentum;
  }
  motion.energy *= density * grid.cellVolume();
  motion.momentum *= density * grid.cellVolume();
  return motion;
}

double liquidPotential(const MacGrid& grid, const FreeSurface& surface, const SolidFractions& solids, double density,
                       const Eigen::Vector3d& gravity) {
  const Lattice& l = grid.lattice;
  std::vector<double> planes(l.n[2], 0.0);  // as above
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      const double* distance = surface.distance().data() + l.index(0, j, k);
      const double* fluid = solids.cell_fluid.data() + l.index(0, j, k);
      // Parts of the cells, and their first moment along x.
      double sum = 0.0, moment = 0.0;
#pragma omp simd reduction(+ : sum, moment)
      for (int i = 0; i < l.n[0]; ++i) {
        const double inside = 0.5 - distance[i], below = inside < 0.0 ? 0.0 : inside;
        const double part = (below > 1.0 ? 1.0 : below) * fluid[i];
        sum += part;
        moment += i * part;
      }
      // The liquid of a cell that the surface or a solid cuts is not at its centre.
      for (int i = 0; i < l.n[0]; ++i) {
        const bool by_surface = std::abs(distance[i])<0.5, by_solid = fluid[i]> 0.0 && fluid[i] < 1.0;
        if (!(by_surface || (by_solid && distance[i] < 0.0))) continue;
        const auto c = l.index(i, j, k);
        const double part = by_surface ? 0.5 - distance[i] : 1.0;
        Eigen::Vector3d off = (part - 1.0) * surface.normal(c);
        if (by_solid) off += (1.0 - fluid[i]) * slopeOf(l, solids.cell_distance, c).normalized();
        planes[k] -= part * fluid[i] * gravity.dot(0.5 * grid.h * off);
      }
      planes[k] -= sum * gravity.dot(grid.cellCenter(0, j, k)) + moment * grid.h * gravity[0];
    }
  }
  double potential = 0.0;
  for (const double plane : planes) potential += plane;
  return potential * (density * grid.cellVolume());
}

std::vector<SurfacePoint> sampleSurface(const MacGrid& grid, const FreeSurface& surface,
                                        const std::vector<float>& cell_distance, const FaceField<double>& velocity) {
  std::vector<SurfacePoint> points;
  if (surface.full() || surface.empty()) return points;
  const Lattice& l = grid.lattice;
  const auto& d = surface.distance();
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (std::abs(d[c]) > 1.0 || cell_distance[c] <= kWhollySolid) continue;
        const Eigen::Vector3d normal = surface.normal(c);
        // The foot on the surface, if it lies in this cell's share: one point for a cell that the surface crosses. The
        // level set is a distance only in the mean: its slope there tells how far.
        const Eigen::Vector3d shift = -d[c] / std::max(slopeOf(l, d, c).norm(), kLeastSlope) * normal;
        if (shift.cwiseAbs().maxCoeff() > 0.5 + 1e-9) continue;
        const Eigen::Vector3d cells = Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5) + shift;
        SurfacePoint point;
        point.position = (grid.origin + grid.h * cells).cast<float>();
        point.normal = normal.cast<float>();
        point.velocity = velocityAt(l, velocity, cells).cast<float>();
        points.push_back(point);
      }
    }
  }
  return points;
}

}  // namespace monolith
