#include "coupling/solid_fractions.h"

#include <algorithm>
#include <cmath>

#include "coupling/displaced_moments.h"
#include "coupling/octant_fractions.h"

namespace monolith {
namespace {

constexpr float kFar = 1e3f;          // cell widths: no solid in sight
// A face with less of it is closed. Its velocity would be the flux of what moves behind it over this: a body that comes
// to lie on another would end on a film of it, in pockets whose pressure and the contact's force are known by their sum
// alone, and in the corner of a container liquid would be shot about.
constexpr double kLeastFluid = 0.02;
// A face's centre nearer to a surface than this, in cell widths, lies on it: what is left of its share of liquid would
// be the only way into the cell behind it, a pivot as small as round-off.
constexpr double kOnSurface = 1e-3;
// Cell widths: a surface farther than half the diagonal from its centre does not cut a cell.
constexpr double kUncut = 0.9;
constexpr int kMargin = 2;  // cells around a body in which its distance is wanted
constexpr double kHardlyMoved = 1e-6;  // cell widths, of any of its points: far below what the solve resolves

// Index of a face that may lie in a periodic image; -1 outside the tank.
std::ptrdiff_t faceIndex(const Lattice& l, const std::array<int, 3>& at, int axis) {
  return l.indexInTank(at, {axis == 0, axis == 1, axis == 2});
}

// A box longer than a period holds cells of the grid twice.
bool holdsCellsOnce(const Lattice& l, const BodyFractions& box) {
  for (int a = 0; a < 3; ++a) {
    if (l.periodic[a] && box.count[a] > l.n[a]) return false;
  }
  return true;
}

bool isWallFace(const Lattice& l, int axis, int at) { return !l.periodic[axis] && (at == 0 || at == l.n[axis]); }

// f(place, distance): distance to the nearest wall, in cell widths, of a sample of every cell and of the halo, where it
// is negative; offset: of the sample from its cell's low corner.
template <class Function>
void forEachWallDistance(const Lattice& l, const Eigen::Vector3d& offset, Function&& f) {
#pragma omp parallel for schedule(static)
  for (int k = -Lattice::kLowHalo; k < l.n[2] + Lattice::kHighHalo; ++k) {
    for (int j = -Lattice::kLowHalo; j < l.n[1] + Lattice::kHighHalo; ++j) {
      const Eigen::Vector3d x = Eigen::Vector3d(0.0, j, k) + offset;
      double beside = kFar;
      for (int a = 1; a < 3; ++a) {
        if (!l.periodic[a]) beside = std::min({beside, x[a], l.n[a] - x[a]});
      }
      const auto row = l.index(0, j, k);
      for (int i = -Lattice::kLowHalo; i < l.n[0] + Lattice::kHighHalo; ++i) {
        const double along = i + offset[0];
        f(row + i, static_cast<float>(l.periodic[0] ? beside : std::min({beside, along, l.n[0] - along})));
      }
    }
  }
}

// f(axis, {i, j, k}, g) for every place of a body's box that the body takes a part of; g: its face on the grid, or -1.
// Shared among threads by k.
template <class Function>
void forEachFace(const Lattice& l, const BodyFractions& box, Function&& f) {
#pragma omp parallel for schedule(static, kPlanesInTurn) if (holdsCellsOnce(l, box))
  for (int k = 0; k < box.count[2]; ++k) {
    for (int a = 0; a < 3; ++a) {
      for (int j = 0; j < box.count[1]; ++j) {
        for (int i = 0; i < box.count[0]; ++i) {
          if (box.face[a][box.local(i, j, k)] == 0.0) continue;
          f(a, std::array<int, 3>{i, j, k}, faceIndex(l, {box.low[0] + i, box.low[1] + j, box.low[2] + k}, a));
        }
      }
    }
  }
}

}  // namespace

std::vector<std::uint8_t> rowsOfBodies(const Lattice& l, const std::vector<BodyFractions>& bodies) {
  const int rows = l.faceEnd(1), planes = l.faceEnd(2);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(rows) * planes, 0);
  for (const BodyFractions& body : bodies) {
    for (int k = body.low[2]; k < body.low[2] + body.count[2]; ++k) {
      for (int j = body.low[1]; j < body.low[1] + body.count[1]; ++j) {
        const int at_j = l.wrapped(1, j), at_k = l.wrapped(2, k);
        if (at_j < 0 || at_j >= rows || at_k < 0 || at_k >= planes) continue;
        out[at_j + static_cast<std::size_t>(rows) * at_k] = 1;
      }
    }
  }
  return out;
}

void SolidSampler::sample(const std::vector<RigidBody>& bodies, SolidFractions& out) {
  // The tank without bodies. What lies beyond the halo is never looked at.
  const Lattice& l = grid_.lattice;
  for (int a = 0; a < 3; ++a) {
    out.fluid[a].resize(l.size, 0.0);
    out.distance[a].resize(l.size, -kFar);
    out.owner[a].resize(l.size, SolidFractions::kWall);
    Eigen::Vector3d offset = Eigen::Vector3d::Constant(0.5);
    offset[a] = 0.0;
    forEachWallDistance(l, offset, [&](std::ptrdiff_t f, float d) {
      out.distance[a][f] = std::min(d, SolidFractions::kFarthest);
      out.fluid[a][f] = d > 0.0f ? 1.0 : 0.0;
      out.owner[a][f] = SolidFractions::kWall;
    });
  }
  out.cell_distance.resize(l.size, -kFar);
  out.cell_fluid.resize(l.size, 0.0);
  forEachWallDistance(l, Eigen::Vector3d::Constant(0.5), [&](std::ptrdiff_t c, float d) {
    out.cell_distance[c] = d;
    out.cell_fluid[c] = d > 0.0f ? 1.0 : 0.0;
  });
  out.bodies.resize(bodies.size());
  samples_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!serves(samples_[b], bodies[b])) sampleBody(bodies[b], samples_[b]);
    addBody(samples_[b], static_cast<int>(b), out);
  }
  close(out);
}

bool SolidSampler::serves(const BodySample& sample, const RigidBody& body) const {
  return sample.shape == body.distance.get() && !(body.distanceFrom(sample.pose) > kHardlyMoved * grid_.h);
}

bool SolidSampler::placeBox(const Eigen::AlignedBox3d& box, BodyFractions& f) const {
  const Lattice& l = grid_.lattice;
  const double h = grid_.h;
  bool whole = true;
  for (int a = 0; a < 3; ++a) {
    const double low = (box.min()[a] - grid_.origin[a]) / h;
    const double high = (box.max()[a] - grid_.origin[a]) / h;
    f.endless[a] = false;
    int first = static_cast<int>(std::floor(std::clamp(low, -1e6, 1e6))) - kMargin;
    int last = static_cast<int>(std::floor(std::clamp(high, -1e6, 1e6))) + kMargin;
    if (!l.periodic[a]) {
      first = std::clamp(first, -1, l.n[a]);
      last = std::clamp(last, -1, l.n[a]);
      whole = whole && low >= -1.0 && high <= l.n[a] + 1;
    } else if (high - low > l.n[a] + kMargin) {
      // Longer than the tank's period: endless, and one period of it counts, far from where the shape ends.
      first += (last - first + 1 - l.n[a]) / 2;
      last = first + l.n[a] - 1;
      f.endless[a] = true;
      whole = false;
    }
    f.low[a] = first;
    f.count[a] = std::max(0, last - first + 1);
  }
  return whole;
}

void SolidSampler::sampleBody(const RigidBody& body, BodySample& out) const {
  const Eigen::Isometry3d X_WB = body.pose();
  const Eigen::Isometry3d X_BW = X_WB.inverse();
  const Eigen::Matrix3d R_WB = X_WB.linear();
  out.shape = body.distance.get();
  out.pose = X_WB;
  BodyFractions& f = out.fractions;
  const bool whole = placeBox(body.distance->bounds().transformed(X_WB), f);
  const std::size_t size = static_cast<std::size_t>(f.count[0]) * f.count[1] * f.count[2];
  for (auto& field : f.face) field.assign(size, 0.0);
  f.cell.assign(size, 0.0);
  for (auto& field : out.distance) field.assign(size, kFar);
  out.cell_distance.resize(size);
  if (size == 0) return;

  std::vector<CellHalves> halves(size);
  sampleCells(*body.distance, X_BW, R_WB, out, halves);
  joinHalves(halves, f);
  if (whole && body.displacement) {
    fitMoments(grid_, {body.displacement->volume, X_WB * body.displacement->centre}, f);
  }
}

void SolidSampler::sampleCells(const SignedDistance& shape, const Eigen::Isometry3d& X_BW, const Eigen::Matrix3d& R_WB,
                               BodySample& out, std::vector<CellHalves>& halves) const {
  const double h = grid_.h;
  BodyFractions& f = out.fractions;
  FaceField<float>& distance = out.distance;
  std::vector<float>& cell_distance = out.cell_distance;
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < f.count[2]; ++k) {
    for (int j = 0; j < f.count[1]; ++j) {
      for (int i = 0; i < f.count[0]; ++i) {
        const std::size_t c = f.local(i, j, k);
        const Eigen::Vector3d x_W = grid_.cellCenter(f.low[0] + i, f.low[1] + j, f.low[2] + k);
        const Eigen::Vector3d x_B = X_BW * x_W;
        const double d = shape.distance(x_B) / h;
        cell_distance[c] = static_cast<float>(d);
        // Beyond 1.5 cells no face of the cell is next to the surface: sign and rough size are enough.
        if (std::abs(d) > 1.5) {
          const bool inside = d < 0.0;
          for (auto& field : distance) field[c] = static_cast<float>(d);
          halves[c].fill(inside ? 1.0f : 0.0f);
          f.cell[c] = inside ? 1.0 : 0.0;
          continue;
        }
        for (int a = 0; a < 3; ++a) {
          Eigen::Vector3d shift = Eigen::Vector3d::Zero();
          shift[a] = -0.5 * h;
          const double at_face = shape.distance(X_BW * (x_W + shift)) / h;
          distance[a][c] = std::abs(at_face) < kOnSurface ? 0.0F : static_cast<float>(at_face);
        }
        std::array<double, 8> octants;
        if (std::abs(d) > kUncut) {
          octants.fill(d < 0.0 ? 1.0 : 0.0);
        } else {
          octantFractions(shape, x_B, R_WB, h, octants);
        }
        double cell = 0.0;
        std::array<double, 6> half{};
        for (int o = 0; o < 8; ++o) {
          cell += 0.125 * octants[o];
          for (int a = 0; a < 3; ++a) half[2 * a + ((o >> a) & 1)] += 0.25 * octants[o];
        }
        f.cell[c] = cell;
        for (int s = 0; s < 6; ++s) halves[c][s] = static_cast<float>(half[s]);
      }
    }
  }
}

void SolidSampler::joinHalves(const std::vector<CellHalves>& halves, BodyFractions& f) {
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < f.count[2]; ++k) {
    for (int j = 0; j < f.count[1]; ++j) {
      for (int i = 0; i < f.count[0]; ++i) {
        const std::size_t c = f.local(i, j, k);
        const std::array<int, 3> at = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          double low_part = 0.0;
          std::array<int, 3> before = at;
          before[a] = f.within(a, at[a] - 1);
          if (before[a] >= 0) {
            low_part = halves[f.local(before[0], before[1], before[2])][2 * a + 1];
          }
          // What will be closed belongs to the body's volume.
          const double part = 0.5 * (low_part + halves[c][2 * a]);
          f.face[a][c] = part > 1.0 - kLeastFluid ? 1.0 : part;
        }
      }
    }
  }
}

void SolidSampler::addBody(const BodySample& sample, int index, SolidFractions& out) const {
  const Lattice& l = grid_.lattice;
  BodyFractions& f = out.bodies[index];
  f = sample.fractions;
#pragma omp parallel for schedule(static, kPlanesInTurn) if (holdsCellsOnce(l, f))
  for (int k = 0; k < f.count[2]; ++k) {
    for (int j = 0; j < f.count[1]; ++j) {
      for (int i = 0; i < f.count[0]; ++i) {
        const std::size_t c = f.local(i, j, k);
        const std::array<int, 3> cell = {f.low[0] + i, f.low[1] + j, f.low[2] + k};
        for (int a = 0; a < 3; ++a) {
          const auto g = faceIndex(l, cell, a);
          if (g >= 0 && sample.distance[a][c] < out.distance[a][g]) {
            out.distance[a][g] = std::max(sample.distance[a][c], -SolidFractions::kFarthest);
            out.owner[a][g] = static_cast<std::int16_t>(index);
          }
        }
        const auto g = l.indexInTank(cell);
        if (g >= 0) {
          out.cell_distance[g] = std::min(out.cell_distance[g], sample.cell_distance[c]);
          out.cell_fluid[g] = std::max(0.0, out.cell_fluid[g] - f.cell[c]);
        }
      }
    }
  }
}

// Makes the fractions of every face sum to one: walls first, then bodies, scaled down where they overlap and up
// where what they leave is negligible.
void SolidSampler::close(SolidFractions& out) const {
  const Lattice& l = grid_.lattice;
  // First what the bodies leave, which is less than nothing where they overlap.
  for (const BodyFractions& f : out.bodies) {
    forEachFace(l, f, [&](int a, const std::array<int, 3>& at, std::ptrdiff_t g) {
      if (g >= 0 && !isWallFace(l, a, f.low[a] + at[a])) out.fluid[a][g] -= f.face[a][f.local(at[0], at[1], at[2])];
    });
  }
  for (BodyFractions& f : out.bodies) {
    std::array<std::vector<std::vector<WallPart>>, 3> at_walls;  // by axis and k
    for (auto& planes : at_walls) planes.resize(f.count[2]);
    forEachFace(l, f, [&](int a, const std::array<int, 3>& place, std::ptrdiff_t g) {
      double& fraction = f.face[a][f.local(place[0], place[1], place[2])];
      const std::array<int, 3> at = {f.low[0] + place[0], f.low[1] + place[1], f.low[2] + place[2]};
      if (g < 0 || isWallFace(l, a, at[a])) {
        if (g >= 0) {
          at_walls[a][place[2]].push_back(
              {a, g, at[a] == 0 ? g : g - l.stride[a], fraction, grid_.faceCenter(a, at[0], at[1], at[2])});
        }
        fraction = 0.0;
      } else if (out.fluid[a][g] < kLeastFluid) {
        fraction /= 1.0 - out.fluid[a][g];
      }
    });
    f.at_walls.clear();
    for (const auto& planes : at_walls) {
      for (const auto& parts : planes) f.at_walls.insert(f.at_walls.end(), parts.begin(), parts.end());
    }
  }
  for (const BodyFractions& f : out.bodies) {
    forEachFace(l, f, [&](int a, const std::array<int, 3>&, std::ptrdiff_t g) {
      if (g >= 0 && out.fluid[a][g] < kLeastFluid) out.fluid[a][g] = 0.0;
    });
  }
  for (int a = 0; a < 3; ++a) {
    fillHalo(l, out.fluid[a]);
    fillHalo(l, out.distance[a]);
    fillHalo(l, out.owner[a]);
  }
  fillHalo(l, out.cell_distance);
  fillHalo(l, out.cell_fluid);
}

}  // namespace monolith
