#include "coupling/stokes_samples.h"

#include <algorithm>

namespace monolith {

void findFaceKinds(const Lattice& l, const StokesGeometry& g, const StaggeredCoefficients<double>& c,
                   const SteadyRows* steady, FaceKinds& kinds) {
  const int low = Lattice::kLowHalo, rows = l.faceEnd(1), planes = l.faceEnd(2);
  const bool keeps = steady != nullptr && kinds[0].size() == l.size;
  const auto isWanted = [&](int j, int k) {
    if (!keeps) return true;
    for (int dk = -1; dk <= 1; ++dk) {
      for (int dj = -1; dj <= 1; ++dj) {
        // Also beyond the ends, where the halo is.
        if (!steady->steady(std::clamp(j + dj, 0, rows - 1), std::clamp(k + dk, 0, planes - 1))) return true;
      }
    }
    return false;
  };
  for (auto& field : kinds) field.resize(l.size);
  const auto stride = l.stride[1];
  const auto findRow = [&](std::ptrdiff_t begin) {
    for (int a = 0; a < 3; ++a) {
      const double* mass = c.mass[a].data() + begin;
      const float* distance = (*g.solid_distance)[a].data() + begin;
      const double* fluid = (*g.fluid)[a].data() + begin;
      FaceKind* kind = kinds[a].data() + begin;
#pragma omp simd
      for (std::ptrdiff_t f = 0; f < stride; ++f) {
        const bool solid = distance[f] <= 0.0f;
        const FaceKind still = solid | (fluid[f] <= 0.0) ? FaceKind::kSolid : FaceKind::kAir;
        const FaceKind moving = solid ? FaceKind::kSliver : FaceKind::kFluid;
        kind[f] = mass[f] > 0.0 ? moving : still;
      }
    }
  };
  // With all of the halo.
  const int high = Lattice::kHighHalo;
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = -low; k < l.n[2] + high; ++k) {
    for (int j = -low; j < l.n[1] + high; ++j) {
      if (isWanted(j, k)) findRow(l.planeBegin(k) + stride * (j + low));
    }
  }
}

void SampleBuilder::markCells(std::ptrdiff_t row, int width, std::vector<std::uint8_t>& mark) const {
  // Of the two bits of a kind both or none are set outside of solids, and the high one where nothing moves.
  static_assert(static_cast<int>(FaceKind::kFluid) == 0 && static_cast<int>(FaceKind::kSliver) == 1 &&
                static_cast<int>(FaceKind::kSolid) == 2 && static_cast<int>(FaceKind::kAir) == 3);
  mark.assign(2 * width, 0);
  std::uint8_t* solid = mark.data();
  std::uint8_t* moving = mark.data() + width;
  for (int a = 0; a < 3; ++a) {
    const auto* kind = reinterpret_cast<const std::uint8_t*>(kinds_[a].data()) + row;
    const auto s = lattice.stride[a];
    const auto sb = lattice.stride[(a + 1) % 3];
    const auto sc = lattice.stride[(a + 2) % 3];
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const std::uint8_t here = kind[i], next = kind[i + s], b = kind[i - sb], c = kind[i - sc];
      solid[i] |= (here ^ (here >> 1)) | (next ^ (next >> 1)) | (b ^ (b >> 1)) | (c ^ (c >> 1));
      moving[i] |= (here & next & b & c) ^ 2;
    }
  }
  std::uint8_t* out = mark.data();
#pragma omp simd
  for (int i = 0; i < width; ++i) out[i] = (moving[i] & 2) == 0 ? kStill : (solid[i] & 1) == 0 ? kPlain : kMixed;
  mark.resize(width);
}

}  // namespace monolith
