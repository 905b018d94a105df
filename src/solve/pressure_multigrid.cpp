#include "solve/pressure_multigrid.h"

#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

constexpr int kSmootherDegree = 3;
constexpr int kCoarsestDegree = 24;

}  // namespace

void PressureMultigrid::set(const StaggeredCoefficients<float>& c) {
  effectiveMass(c, mass_);
  std::size_t count = 1;
  for (Lattice l = c.lattice; canCoarsen(l); l = coarsened(l)) ++count;
  levels_.resize(count);
  Level& fine = levels_[0];
  const Lattice& l = c.lattice;
  fine.lattice = l;
  for (auto& field : fine.conductance) field.assign(l.size, 0.0f);
  fine.to_air.assign(l.size, 0.0f);
  fine.kind.assign(l.size, kOutside);
  for (std::size_t cell = 0; cell < l.size; ++cell) fine.kind[cell] = c.has_pressure[cell] ? kLiquid : kOutside;
  fillHalo(l, fine.kind);
  for (int a = 0; a < 3; ++a) {
    const auto sa = l.stride[a];
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto f = row; f < row + l.faceEnd(0); ++f) {
        if (!(mass_[a][f] > 0.0f)) continue;
        const float conductance = c.open[a][f] * c.open[a][f] / mass_[a][f];
        const bool low = fine.kind[f - sa] == kLiquid;
        const bool high = fine.kind[f] == kLiquid;
        if (low && high) fine.conductance[a][f] = conductance;
      }
    });
    // Towards the air: one cell has pressure, the other not. Its own loop, for it writes to both sides of the row.
    for (int k = 0; k < l.faceEnd(2); ++k) {
      for (int j = 0; j < l.faceEnd(1); ++j) {
        for (int i = 0; i < l.faceEnd(0); ++i) {
          const auto f = l.index(i, j, k);
          if (!(mass_[a][f] > 0.0f) || fine.conductance[a][f] > 0.0f) continue;
          int before[3] = {i, j, k};
          --before[a];
          if (before[a] < 0) before[a] += l.n[a];
          const auto low = l.index(before[0], before[1], before[2]);
          const float conductance = c.open[a][f] * c.open[a][f] / mass_[a][f];
          for (const auto cell : {low, f}) {
            if (fine.kind[cell] == kLiquid) {
              fine.to_air[cell] += conductance;
            } else {
              fine.kind[cell] = kAir;
            }
          }
        }
      }
    }
    fillHalo(l, fine.conductance[a]);
  }
  fillHalo(l, fine.kind);
  finish(fine);
  for (std::size_t index = 1; index < count; ++index) {
    coarsen(levels_[index - 1], levels_[index]);
    finish(levels_[index]);
  }
  levels_.back().range.ratio = count > 1 ? 100.0f : 6.0f;
}

void PressureMultigrid::coarsen(const Level& fine, Level& coarse) const {
  coarse.lattice = coarsened(fine.lattice);
  const Lattice& l = coarse.lattice;
  for (int a = 0; a < 3; ++a) {
    restrictFaces(fine.lattice, a, fine.conductance[a], l, coarse.conductance[a]);
    fillHalo(l, coarse.conductance[a]);
  }
  // Sum over eight children, with the same factor as a sum over four faces.
  restrictCells(fine.lattice, fine.to_air, l, coarse.to_air);
  for (float& value : coarse.to_air) value *= 2.0f;
  coarse.kind.assign(l.size, kOutside);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        Kind& kind = reinterpret_cast<Kind&>(coarse.kind[l.index(i, j, k)]);
        for (int child = 0; child < 8 && kind != kLiquid; ++child) {
          const auto cell = fine.lattice.index(2 * i + (child & 1), 2 * j + ((child >> 1) & 1), 2 * k + (child >> 2));
          if (fine.kind[cell] != kOutside) kind = static_cast<Kind>(fine.kind[cell]);
        }
      }
    }
  }
  fillHalo(l, coarse.kind);
}

void PressureMultigrid::finish(Level& level) const {
  const Lattice& l = level.lattice;
  for (auto* field : {&level.inverse_diagonal, &level.x, &level.b, &level.r, &level.d}) field->assign(l.size, 0.0f);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (auto f = row; f < row + l.faceEnd(0); ++f) {
      if (level.kind[f] != kLiquid) continue;
      float sum = level.to_air[f];
      for (int a = 0; a < 3; ++a) sum += level.conductance[a][f] + level.conductance[a][f + l.stride[a]];
      level.inverse_diagonal[f] = sum > 0.0f ? 1.0f / sum : 0.0f;
    }
  });
  // L is an M-matrix: the spectrum of D^-1 L lies in [0, 2].
  level.range.largest = 2.0f;
  level.range.ratio = 6.0f;
}

// Gives cells in solids and beyond the walls the value next to them, so that interpolation sees no boundary there.
// Cells in the air keep zero, their pressure.
void PressureMultigrid::extend(Level& level) const {
  const Lattice& l = level.lattice;
  std::vector<std::uint8_t> known(l.size);
  for (std::size_t c = 0; c < l.size; ++c) known[c] = level.kind[c] != kOutside;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = known;
    const auto s = l.stride[axis];
    for (auto c = s; c + s < static_cast<std::ptrdiff_t>(l.size); ++c) {
      if (before[c]) continue;
      const int count = before[c - s] + before[c + s];
      if (count == 0) continue;
      level.x[c] = ((before[c - s] ? level.x[c - s] : 0.0f) + (before[c + s] ? level.x[c + s] : 0.0f)) / count;
      known[c] = 1;
    }
  }
}

void PressureMultigrid::residual(Level& level) {
  const Lattice& l = level.lattice;
  fillHalo(l, level.x);
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    const float* x = level.x.data() + row;
    const float* b = level.b.data() + row;
    const float* inverse = level.inverse_diagonal.data() + row;
    const float *gx = level.conductance[0].data() + row, *gy = level.conductance[1].data() + row,
                *gz = level.conductance[2].data() + row;
    const float* to_air = level.to_air.data() + row;
    float* r = level.r.data() + row;
    const auto sy = l.stride[1];
    const auto sz = l.stride[2];
#pragma omp simd
    for (int i = 0; i < width; ++i) {
      const float Lx = to_air[i] * x[i] + gx[i] * (x[i] - x[i - 1]) + gx[i + 1] * (x[i] - x[i + 1]) + gy[i] * (x[i] - x[i - sy]) +
                       gy[i + sy] * (x[i] - x[i + sy]) + gz[i] * (x[i] - x[i - sz]) + gz[i + sz] * (x[i] - x[i + sz]);
      r[i] = inverse[i] > 0.0f ? b[i] - Lx : 0.0f;
    }
  });
}

void PressureMultigrid::smooth(Level& level, int degree, bool from_zero) {
  const auto size = static_cast<std::ptrdiff_t>(level.lattice.size);
  ChebyshevRecurrence recurrence(level.range);
  float* x = level.x.data();
  float* d = level.d.data();
  const float* inverse = level.inverse_diagonal.data();
  for (int step = 0; step < degree; ++step) {
    const bool zero = from_zero && step == 0;
    if (!zero) residual(level);
    if (step > 0) recurrence.next();
    const float keep = step > 0 ? recurrence.keep() : 0.0f;
    const float scale = recurrence.scale();
    const float* r = zero ? level.b.data() : level.r.data();
    if (step == 0) {
#pragma omp parallel for simd schedule(static)
      for (std::ptrdiff_t c = 0; c < size; ++c) {
        d[c] = scale * inverse[c] * r[c];
        x[c] = (zero ? 0.0f : x[c]) + d[c];
      }
    } else {
#pragma omp parallel for simd schedule(static)
      for (std::ptrdiff_t c = 0; c < size; ++c) {
        d[c] = keep * d[c] + scale * inverse[c] * r[c];
        x[c] += d[c];
      }
    }
  }
}

void PressureMultigrid::descend(std::size_t index) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) {
    smooth(level, kCoarsestDegree, true);
    return;
  }
  smooth(level, kSmootherDegree, true);
  residual(level);
  Level& coarse = levels_[index + 1];
  restrictCells(level.lattice, level.r, coarse.lattice, coarse.b);
  // The operator is scaled by the cell width squared, which doubles twice per level.
  for (float& b : coarse.b) b *= 4.0f;
  descend(index + 1);
  fillHalo(coarse.lattice, coarse.x);
  extend(coarse);
  clearHalo(level.lattice, level.x);
  prolongateCells(coarse.lattice, coarse.x, level.lattice, level.inverse_diagonal, level.x);
  smooth(level, kSmootherDegree, false);
}

void PressureMultigrid::cycle(const std::vector<float>& b, std::vector<float>& x) {
  levels_[0].b = b;
  descend(0);
  x = levels_[0].x;
  clearHalo(levels_[0].lattice, x);
}

}  // namespace monolith
