#include "coupling/stokes_coefficients.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "coupling/stokes_samples.h"
#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

// A cell whose centre is less than this below the surface counts as dry: no face with a tiny part of liquid.
constexpr double kLeastLiquid = 1e-3;  // cell widths

bool isWet(double distance) { return distance < -kLeastLiquid; }

// liquidPart(), in one expression for the vector units.
inline double partOfSegment(double distance_low, double distance_high) {
  const double wet = std::min(distance_low, distance_high);
  const double dry = std::max(distance_low, distance_high);
  // A dry cell may lie just below the surface: the part is then just above one, and liquid at rest stays so.
  const double part = std::min(std::max(wet / (wet - dry), kLeastLiquid), 1.0 + 2.0 * kLeastLiquid);
  const double cut = wet < -kLeastLiquid ? part : 0.0;
  return dry < -kLeastLiquid ? 1.0 : cut;
}

constexpr double kLeastSliver = 0.05;

// Beyond the walls: solid, half a cell from them. Along periodic axes the images.
void closeHalo(const Lattice& l, int face_axis, std::vector<float>& distance) {
  int end[3];
  for (int a = 0; a < 3; ++a) end[a] = a == face_axis ? l.faceEnd(a) : l.n[a];
#pragma omp parallel for schedule(static) if (l.size >= kSizeWorthSharing)
  for (int k = -Lattice::kLowHalo; k < l.n[2] + Lattice::kHighHalo; ++k) {
    for (int j = -Lattice::kLowHalo; j < l.n[1] + Lattice::kHighHalo; ++j) {
      const bool beside = j < 0 || j >= end[1] || k < 0 || k >= end[2];
      float* row = distance.data() + l.index(0, j, k);
      if (beside) std::fill_n(row, end[0], -0.5f);
      for (int i = -Lattice::kLowHalo; i < 0; ++i) row[i] = -0.5f;
      for (int i = end[0]; i < l.n[0] + Lattice::kHighHalo; ++i) row[i] = -0.5f;
    }
  }
  fillHalo(l, distance);
}

// As out.resize(), but what buildCoefficients() writes anyway is not cleared first: it is most of the memory there is.
void prepareToFill(const Lattice& l, bool viscous, StaggeredCoefficients<double>& out) {
  const bool same = out.lattice.n == l.n && out.lattice.periodic == l.periodic && out.viscous == viscous &&
                    out.has_pressure.size() == l.size;
  if (!same) out.resize(l, viscous);
}

// The viscous samples of one cell, whatever is around it.
void buildSamples(const SampleBuilder& samples, const StaggeredCoefficients<double>& coefficients,
                  double viscous_number, std::ptrdiff_t c, ViscousPlane& out, StrainScales* strain) {
  const Lattice& l = samples.lattice;
  const std::ptrdiff_t at = c - out.begin;
  for (int a = 0; a < 3; ++a) {
    const FittedSegment s = samples.segment(a, c, a);
    if (s.defined && !s.both_solid) {
      // eta |D_aa|^2: D^T D gives 2 N per unit weight; weight theta over theta^2.
      out.normal[a][at] = static_cast<float>(2.0 * viscous_number * samples.liquidOfCell(c) / s.theta);
      if (strain != nullptr && out.normal[a][at] > 0.0F) strain->normal[a][c] = 1.0 / s.theta;
    }
    if (samples.kind(a, c) == FaceKind::kSliver) {
      // The film between the face's open part and the surface is about half the open part thick.
      const double open = std::max(coefficients.open(a)[c], kLeastSliver);
      out.drag[a][at] = static_cast<float>(4.0 * viscous_number / open);
      if (strain != nullptr) strain->drag[a][c] = 2.0 / open;
    }
  }
  for (int p = 0; p < 3; ++p) {
    const auto [a, b] = kShearPairs[p];
    const FittedSegment s = samples.segment(a, c - l.stride[b], b);
    const FittedSegment t = samples.segment(b, c - l.stride[a], a);
    if (!s.defined || !t.defined) continue;
    // eta 2 (1/2 (du + dv))^2, energy weight times N, its square root shared between the two differences.
    const auto& d = *samples.geometry.solid_distance;
    const double share = shearWeight(s, t, d[a][c - l.stride[b]], d[a][c], d[b][c - l.stride[a]], d[b][c]);
    const double weight = std::sqrt(viscous_number * samples.liquidOfEdge(c, a, b) * share);
    out.shear[p][0][at] = static_cast<float>(weight / s.theta);
    out.shear[p][1][at] = static_cast<float>(weight / t.theta);
    if (strain != nullptr && weight > 0.0) strain->shear[p][c] = 1.0 / weight;
  }
}

// The same for the cells of a row that markCells() found plain; zero for the others.
void buildPlainRow(const SampleBuilder& samples, double viscous_number, std::ptrdiff_t row,
                   const std::vector<std::uint8_t>& mark, ViscousPlane& out) {
  constexpr auto kAir = static_cast<std::uint8_t>(FaceKind::kAir);
  const Lattice& l = samples.lattice;
  const int width = static_cast<int>(mark.size());
  const std::uint8_t* m = mark.data();
  const double* d = samples.geometry.liquid_distance->data() + row;
  const double number = 2.0 * viscous_number;
  const auto part = [](double x) { return std::min(std::max(0.5 - x, 0.0), 1.0); };
  const auto kindsOf = [&](int a) { return reinterpret_cast<const std::uint8_t*>(samples.kinds(a)) + row; };
  thread_local std::vector<std::uint8_t> joined;  // cells whose sample has no end in the air
  joined.resize(width);
  std::uint8_t* has = joined.data();
  for (int a = 0; a < 3; ++a) {
    const std::uint8_t* kind = kindsOf(a);
    const auto s = l.stride[a];
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      has[i] = (m[i] == SampleBuilder::kPlain) & (kind[i] != kAir) & (kind[i + s] != kAir);
    }
    float* normal = out.normal[a].data() + (row - out.begin);
#pragma omp simd
    for (int i = 0; i < width; ++i) normal[i] = static_cast<float>(has[i] ? number * part(d[i]) : 0.0);
  }
  for (int p = 0; p < 3; ++p) {
    const auto sa = l.stride[kShearPairs[p][0]], sb = l.stride[kShearPairs[p][1]];
    const std::uint8_t *kind_a = kindsOf(kShearPairs[p][0]), *kind_b = kindsOf(kShearPairs[p][1]);
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      has[i] = (m[i] == SampleBuilder::kPlain) & (kind_a[i] != kAir) & (kind_a[i - sb] != kAir) & (kind_b[i] != kAir) &
               (kind_b[i - sa] != kAir);
    }
    float* first = out.shear[p][0].data() + (row - out.begin);
    float* second = out.shear[p][1].data() + (row - out.begin);
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const double liquid = part(0.25 * (d[i] + d[i - sa] + d[i - sb] + d[i - sa - sb]));
      const auto weight = static_cast<float>(has[i] ? std::sqrt(viscous_number * liquid) : 0.0);
      first[i] = weight;
      second[i] = weight;
    }
  }
}

template <class Real>
void scale(Real factor, std::vector<Real>& field) {
#pragma omp parallel for simd schedule(static) if (field.size() >= kSizeWorthSharing)
  for (std::size_t i = 0; i < field.size(); ++i) field[i] *= factor;
}

}  // namespace

double liquidPart(double distance_low, double distance_high) { return partOfSegment(distance_low, distance_high); }

void StrainScales::resize(const Lattice& l) {
  for (auto* fields : {&normal, &shear, &drag}) {
    for (auto& field : *fields) field.assign(l.size, 0.0);
  }
}

void StrainScales::fillHalos(const Lattice& l) {
  for (auto* fields : {&normal, &shear, &drag}) {
    for (auto& field : *fields) fillHalo(l, field);
  }
}

void buildCoefficients(const Lattice& l, const StokesGeometry& geometry, double viscous_number,
                       StaggeredCoefficients<double>& out, FaceKinds& kinds, StrainScales* strain,
                       const SteadyRows* steady) {
  out.others_fluid = geometry.fluid;
  prepareToFill(l, viscous_number > 0.0, out);
  const auto keeps = [&](int j, int k) { return steady != nullptr && steady->steady(j, k); };
  const auto& liquid = *geometry.liquid_distance;
  const int width = l.faceEnd(0);
  forEachHeavyRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (keeps(j, k)) return;
    for (int a = 0; a < 3; ++a) {
      const double* fluid = (*geometry.fluid)[a].data();
      for (auto f = row; f < row + width; ++f) {
        const double mass = fluid[f] * partOfSegment(liquid[f - l.stride[a]], liquid[f]);
        out.mass[a][f] = mass > 0.0 ? mass : 0.0;
      }
    }
  });
  for (auto& field : out.mass) fillHalo(l, field);
  const int end[3] = {l.n[0], l.n[1], l.n[2]};
  forEachHeavyRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= end[1] || k >= end[2] || keeps(j, k)) return;
    for (auto c = row; c < row + end[0]; ++c) {
      double sum = 0.0;
      for (int a = 0; a < 3; ++a) sum += out.open(a)[c] + out.open(a)[c + l.stride[a]];
      out.has_pressure[c] = isWet(liquid[c]) & (sum > 0.0);
    }
  });
  if (!out.viscous) return;

  if (strain != nullptr) strain->resize(l);
  findFaceKinds(l, geometry, out, steady, kinds);
  const SampleBuilder samples(l, geometry, kinds);
#pragma omp parallel for schedule(dynamic) if (l.size >= kHeavySizeWorthSharing)
  for (int k = 0; k < l.faceEnd(2); ++k) {
    int j = 0;
    while (j < l.faceEnd(1) && keeps(j, k)) ++j;
    if (j == l.faceEnd(1)) continue;
    thread_local ViscousPlane plane;
    thread_local std::vector<std::uint8_t> mark;
    plane.unpack(out, k);
    for (; j < l.faceEnd(1); ++j) {
      if (keeps(j, k)) continue;
      const std::ptrdiff_t row = l.index(0, j, k);
      const std::ptrdiff_t at = row - plane.begin;
      for (auto& field : plane.drag) std::fill_n(field.data() + at, width, 0.0F);
      samples.markCells(row, width, mark);
      if (std::memchr(mark.data(), SampleBuilder::kPlain, width) != nullptr) {
        buildPlainRow(samples, viscous_number, row, mark, plane);
      } else {
        for (auto& field : plane.normal) std::fill_n(field.data() + at, width, 0.0F);
        for (auto& pair : plane.shear) {
          for (auto& field : pair) std::fill_n(field.data() + at, width, 0.0F);
        }
      }
      for (int i = 0; i < width; ++i) {
        if (mark[i] == SampleBuilder::kStill || (mark[i] == SampleBuilder::kPlain && strain == nullptr)) continue;
        buildSamples(samples, out, viscous_number, row + i, plane, strain);
      }
    }
    plane.pack(k, out);
  }
  out.forEachViscous([](RowField<float>& field) { field.shareImages(); });
  if (strain != nullptr) strain->fillHalos(l);
}

void buildCoarseLevels(const Lattice& lattice, const StokesGeometry& geometry, double viscous_number,
                       double least_number, std::vector<StaggeredCoefficients<float>>& levels) {
  Lattice l = lattice;
  FaceField<double> fluid;
  FaceField<float> distance;
  std::vector<double> liquid, to;
  std::vector<float> single;
  StaggeredCoefficients<double> coefficients;
  FaceKinds kinds;
  std::size_t count = 1;
  while (canCoarsen(l) && viscous_number > least_number) {
    const Lattice coarse = coarsened(l);
    const bool first = count == 1;
    for (int a = 0; a < 3; ++a) {
      restrictFaces(l, a, first ? (*geometry.fluid)[a] : fluid[a], coarse, to);
      fillHalo(coarse, to);
      fluid[a].swap(to);
      restrictFaces(l, a, first ? (*geometry.solid_distance)[a] : distance[a], coarse, single);
      scale(0.5f, single);
      closeHalo(coarse, a, single);
      distance[a].swap(single);
    }
    restrictCells(l, first ? *geometry.liquid_distance : liquid, coarse, to);
    scale(0.5, to);
    extendIntoHalo(coarse, to);
    liquid.swap(to);
    viscous_number *= 0.25;
    l = coarse;
    StokesGeometry g{&fluid, &distance, &liquid};
    buildCoefficients(l, g, viscous_number, coefficients, kinds);
    if (levels.size() <= count) levels.resize(count + 1);
    convertCoefficients(coefficients, levels[count++]);
  }
  levels.resize(count);
}

}  // namespace monolith
