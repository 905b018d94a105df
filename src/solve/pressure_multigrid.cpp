#include "solve/pressure_multigrid.h"

#include <algorithm>
#include <cstring>

#include "solve/kernel_work.h"
#include "solve/staggered_transfer.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr int kSmootherDegree = 3;
constexpr float kRatio = 6.0f;
constexpr int kCoarsestDegree = 24;  // where there are too many cells to be solved directly
constexpr float kCoarsestRatio = 100.0f;
constexpr std::size_t kDirectCells = 216;
// Of the diagonal: makes a sealed tank's network definite. Its right sides hold no constant but for round-off.
constexpr double kShift = 1e-5;
constexpr float kLargestLift = 1.5f;

// A conductance g to the air says that the surface is 1/g cells above the cell's centre. The centre of the coarse cell
// is half a fine cell lower, or higher if the surface runs through it.
float liftedToAir(float g, bool inside) {
  return inside ? 2.0f * g / (1.0f - 0.5f * std::min(g, kLargestLift)) : 2.0f * g / (1.0f + 0.5f * g);
}

// Those that hold a cell of this kind.
Planes planesWith(std::uint8_t wanted, const std::vector<std::uint8_t>& kind, const Lattice& l) {
  Planes out;
  for (int k = 0; k < l.n[2]; ++k) {
    if (std::memchr(kind.data() + l.planeBegin(k), wanted, static_cast<std::size_t>(l.stride[2])) == nullptr) continue;
    if (out.end == 0) out.first = k;
    out.end = k + 1;
  }
  return out;
}

}  // namespace

float PressureMultigrid::FinestNetwork::toAir(std::ptrdiff_t c) const {
  float sum = 0.0F;
  for (int a = 0; a < 3; ++a) {
    const auto sa = lattice.stride[a];
    if (!pressed(c - sa)) sum += whole(a, c);
    if (!pressed(c + sa)) sum += whole(a, c + sa);
  }
  return sum;
}

const std::vector<float>& PressureMultigrid::FinestNetwork::allConductances(int axis, std::vector<float>& room) const {
  assignZero(lattice.size, room);
  float* to = room.data();
  forEachRow(lattice, [&](std::ptrdiff_t row, int, int) {
    const double* open = fluid[axis].data() + row;
    const float* moved = impulse[axis].row(row);
    const std::uint8_t *here = kinds.data() + row, *before = here - lattice.stride[axis];
#pragma omp simd
    for (int i = 0; i < lattice.faceEnd(0); ++i) {
      const bool between = (here[i] == kLiquid) & (before[i] == kLiquid);
      to[row + i] = between ? static_cast<float>(open[i]) * moved[i] : 0.0F;
    }
  });
  fillHalo(lattice, room);
  return room;
}

// First which cells have a pressure; those around tell the rest.
void PressureMultigrid::findKinds(const Lattice& l, const std::vector<std::uint8_t>& has_pressure,
                                  const FaceField<double>& fluid, const FaceRows<float>& impulse,
                                  const SteadyRows* steady) {
  const bool keeps = levels_[0].blocks.wouldKeep(steady) && kinds_.size() == l.size;
  const auto keepsRow = [&](int j, int k) { return keeps && steady->steady(j, k); };
  if (!keeps) assignZero(l.size, kinds_);
  const int width = l.faceEnd(0);
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (keepsRow(j, k)) return;
    for (auto c = row; c < row + width; ++c) kinds_[c] = has_pressure[c] ? kLiquid : kOutside;
  });
  const FinestNetwork network{l, fluid, impulse, kinds_};
  forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
    if (keepsRow(j, k)) return;
    for (auto c = row; c < row + width; ++c) {
      if (kinds_[c] == kLiquid) continue;
      bool flows = false;
      for (int a = 0; a < 3; ++a)
        flows = flows || network.whole(a, c) > 0.0F || network.whole(a, c + l.stride[a]) > 0.0F;
      if (flows) kinds_[c] = kAir;
    }
  });
  fillHalo(l, kinds_);
}

void PressureMultigrid::set(const Lattice& l, const std::vector<std::uint8_t>& has_pressure,
                            const FaceField<double>& fluid, const FaceRows<float>& impulse, const SteadyRows* steady,
                            const std::vector<std::uint8_t>* smoothed) {
  std::size_t count = 1;
  for (Lattice c = l; canCoarsen(c); c = coarsened(c)) ++count;
  levels_.resize(count);
  findKinds(l, has_pressure, fluid, impulse, steady);
  const FinestNetwork finest{l, fluid, impulse, kinds_};
  levels_[0].lattice = l;
  finish(finest, kinds_, steady, smoothed, levels_[0]);
  Network last;
  for (std::size_t index = 1; index < count; ++index) {
    Network coarse;
    levels_[index].lattice = coarsened(levels_[index - 1].lattice);
    if (index == 1) {
      coarsen(l, finest, levels_[index].lattice, coarse);
    } else {
      coarsen(levels_[index - 1].lattice, last, levels_[index].lattice, coarse);
    }
    finish(coarse, coarse.kinds, nullptr, nullptr, levels_[index]);
    findExtension(coarse, levels_[index]);
    last = std::move(coarse);
  }
  levels_.back().range.ratio = kCoarsestRatio;
  coarsest_cells_.clear();
  if (count > 1) invert(last, levels_.back());
}

template <class SomeNetwork>
void PressureMultigrid::coarsen(const Lattice& from, const SomeNetwork& fine, const Lattice& l, Network& coarse) const {
  std::vector<float> room;
  for (int a = 0; a < 3; ++a) {
    restrictFaces(from, a, fine.allConductances(a, room), l, coarse.conductances[a]);
    fillHalo(l, coarse.conductances[a]);
  }
  coarse.to_air.assign(l.size, 0.0f);
  coarse.kinds.assign(l.size, kOutside);
#pragma omp parallel for schedule(static, kPlanesInTurn) if (from.size >= kSizeWorthSharing)
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        bool liquid = false, air = false, beyond = false;
        for (int child = 0; child < 8; ++child) {
          const auto cell = from.index(2 * i + (child & 1), 2 * j + ((child >> 1) & 1), 2 * k + (child >> 2));
          liquid = liquid || fine.kind(cell) == kLiquid;
          air = air || fine.kind(cell) == kAir;
          beyond = beyond || fine.beyond(cell);
        }
        const auto c = l.index(i, j, k);
        coarse.kinds[c] = liquid ? kLiquid : air ? kAir : kOutside;
        if (!liquid) continue;
        float sum = 0.0f;
        for (int child = 0; child < 8; ++child) {
          const auto cell = from.index(2 * i + (child & 1), 2 * j + ((child >> 1) & 1), 2 * k + (child >> 2));
          const bool pressed = fine.kind(cell) == kLiquid;
          sum += liftedToAir(pressed ? fine.toAir(cell) : 0.0F, beyond);
        }
        // Over eight children, with the same factor as over four faces.
        coarse.to_air[c] = 0.25f * sum;
      }
    }
  }
  fillHalo(l, coarse.kinds);
  fillHalo(l, coarse.to_air);
  coarse.across.assign(l.size, 0);
  forEachRow(l, [&](std::ptrdiff_t row, int, int) {
    for (auto c = row; c < row + l.n[0]; ++c) {
      if (coarse.kind(c) == kLiquid) continue;
      coarse.across[c] = coarse.kind(c) == kAir;
      for (const auto s : l.stride) {
        for (const auto other : {c - s, c + s}) coarse.across[c] |= coarse.to_air[other] > 0.0f;
      }
    }
  });
}

template <class SomeNetwork>
void PressureMultigrid::finish(const SomeNetwork& network, const std::vector<std::uint8_t>& kinds,
                               const SteadyRows* steady, const std::vector<std::uint8_t>* smoothed,
                               Level& level) const {
  const Lattice& l = level.lattice;
  if (level.partial != (smoothed != nullptr)) {
    // Other blocks, and fields that held something beyond them.
    level.blocks.distrust();
    level.build = -1;
  }
  level.partial = smoothed != nullptr;
  if (!level.blocks.wouldKeep(steady) || level.mask.size() != l.size) assignZero(l.size, level.mask);
  if (&level != &levels_[0]) assignZero(l.size, level.b);
  level.blocks.build(
      l, {0},
      [&](int, std::ptrdiff_t row, int width, auto& k) {
        const std::uint8_t* kind = kinds.data() + row;
        if (std::find(kind, kind + width, kLiquid) == kind + width) {
          std::fill_n(level.mask.data() + row, width, 0.0f);
          return false;
        }
        for (int i = 0; i < width; ++i) {
          const auto c = row + i;
          const bool liquid = kind[i] == kLiquid;
          float sum = k[kToAir][i] = liquid ? network.toAir(c) : 0.0f;
          for (int a = 0; a < 3; ++a) {
            sum += k[kLow + a][i] = liquid ? network.conductance(a, c) : 0.0f;
            sum += k[kHigh + a][i] = liquid ? network.conductance(a, c + l.stride[a]) : 0.0f;
          }
          level.mask[c] = k[kInverse][i] = sum > 0.0f ? 1.0f / sum : 0.0f;
        }
        if (smoothed == nullptr) return true;
        // Next to smoothed cells the residual is wanted, but nothing is smoothed.
        const auto sy = l.stride[1], sz = l.stride[2];
        for (int i = 0; i < width; ++i) {
          const std::uint8_t* at = smoothed->data() + row + i;
          if (*at) continue;
          k[kInverse][i] = 0.0f;
          if (at[-1] || at[1] || at[-sy] || at[sy] || at[-sz] || at[sz]) continue;
          for (int q = kToAir; q < kInverse; ++q) k[q][i] = 0.0f;
        }
        return true;
      },
      steady);
  // Cells of coarse levels that are continued into hold something, too.
  if (&level != &levels_[0]) level.build = -1;
  for (auto* field : {&level.x, &level.next, &level.d}) level.blocks.clear(0, level.build, *field);
  level.build = level.blocks.build();
  level.planes = planesWith(kLiquid, kinds, l);
  // L is an M-matrix: the spectrum of D^-1 L lies in [0, 2].
  level.range.largest = 2.0f;
  level.range.ratio = kRatio;
}

// Cells in solids and beyond the walls get the value next to them, so that interpolation sees no boundary there. Cells
// in the air keep zero, their pressure.
void PressureMultigrid::findExtension(const Network& network, Level& level) const {
  const Lattice& l = level.lattice;
  level.extension.clear();
  std::vector<std::uint8_t> known(l.size);
#pragma omp parallel for schedule(static) if (l.size >= kSizeWorthSharing)
  for (std::size_t c = 0; c < l.size; ++c) known[c] = network.kinds[c] != kOutside;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = known;
    const auto s = l.stride[axis];
    std::vector<std::vector<Extension>> planes(l.n[2] + 2);
#pragma omp parallel for schedule(static, kPlanesInTurn) if (l.size >= kSizeWorthSharing)
    for (int k = -1; k <= l.n[2]; ++k) {
      for (int j = -1; j <= l.n[1]; ++j) {
        for (int i = -1; i <= l.n[0]; ++i) {
          const int at[3] = {i, j, k};
          const auto c = l.index(i, j, k);
          if (before[c]) continue;
          const bool below = at[axis] > -1 && before[c - s], above = before[c + s];
          if (!below && !above) continue;
          const auto a = static_cast<std::int32_t>(below ? c - s : c + s);
          const auto b = static_cast<std::int32_t>(above ? c + s : c - s);
          planes[k + 1].push_back({static_cast<std::int32_t>(c), a, b});
          known[c] = 1;
        }
      }
    }
    for (const auto& plane : planes) level.extension.insert(level.extension.end(), plane.begin(), plane.end());
  }
}

void PressureMultigrid::invert(const Network& network, const Level& level) {
  const Lattice& l = level.lattice;
  std::vector<int> number(l.size, -1);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (!(level.mask[c] > 0.0f)) continue;
        number[c] = static_cast<int>(coarsest_cells_.size());
        coarsest_cells_.push_back(static_cast<std::int32_t>(c));
      }
    }
  }
  if (coarsest_cells_.size() > kDirectCells) coarsest_cells_.clear();
  if (coarsest_cells_.empty()) return;
  fillHalo(l, number);
  const auto count = static_cast<Eigen::Index>(coarsest_cells_.size());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::ptrdiff_t c = coarsest_cells_[row];
    L(row, row) += network.toAir(c) + kShift / level.mask[c];
    for (int a = 0; a < 3; ++a) {
      for (const auto& [face, other] : {std::pair(c, c - l.stride[a]), std::pair(c + l.stride[a], c + l.stride[a])}) {
        const double g = network.conductance(a, face);
        if (!(g > 0.0) || number[other] < 0) continue;
        L(row, row) += g;
        L(row, number[other]) -= g;
      }
    }
  }
  inverse_ = L.llt().solve(Eigen::MatrixXd::Identity(count, count)).cast<float>();
}

namespace {

// L x of a block, over the pattern's 8 and the field's 7 loads a cell.
constexpr double kNetworkFlops = 19.0;
inline void network(const Lattice& l, const float* k, const float* x, float* out) {
  const auto sy = l.stride[1], sz = l.stride[2];
#pragma omp simd
  for (int i = 0; i < kLanes; ++i) {
    const float at = x[i];
    out[i] = k[i] * at + k[1 * kLanes + i] * (at - x[i - 1]) + k[4 * kLanes + i] * (at - x[i + 1]) +
             k[2 * kLanes + i] * (at - x[i - sy]) + k[5 * kLanes + i] * (at - x[i + sy]) +
             k[3 * kLanes + i] * (at - x[i - sz]) + k[6 * kLanes + i] * (at - x[i + sz]);
  }
}

}  // namespace

// Streams x, b and r: 12 bytes a cell for 20 flops.
void PressureMultigrid::residual(Level& level, float* r) const {
  countWork(level.blocks.lanes(), kNetworkFlops + 1.0, 3.0 * sizeof(float));
  const float *x = level.x.data(), *b = level.right, *mask = level.mask.data();
  if (level.partial) {
    // Away from its blocks x is zero. Coarse cells reach a plane farther, where there may have been liquid before.
    const Lattice& l = level.lattice;
    const std::ptrdiff_t size = l.stride[2];
    const int first = std::max(0, level.planes.first - 1), last = std::min(l.n[2], level.planes.end + 1);
    countWork(static_cast<std::size_t>(size * (last - first)), 0.0, 3.0 * sizeof(float));
#pragma omp parallel for schedule(static)
    for (int k = first; k < last; ++k) {
      const std::ptrdiff_t begin = l.planeBegin(k);
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < begin + size; ++i) r[i] = mask[i] > 0.0f ? b[i] : 0.0f;
    }
  }
  level.blocks.forEach([&](int, std::ptrdiff_t c, const float* k) {
    const float* has = level.partial ? mask + c : k + kInverse * kLanes;
    float Lx[kLanes];
    network(level.lattice, k, x + c, Lx);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) r[c + i] = has[i] > 0.0f ? b[c + i] - Lx[i] : 0.0f;
  });
}

// A step streams x, b, d (read and written) and next: 20 bytes a cell for 25 flops: bound by the second cache or
// memory.
void PressureMultigrid::smooth(Level& level, int degree, bool from_zero) const {
  ChebyshevRecurrence recurrence(level.range);
  const float* b = level.right;
  float* d = level.d.data();
  for (int step = 0; step < degree; ++step) {
    if (step > 0) recurrence.next();
    const float keep = recurrence.keep(), scale = recurrence.scale();
    if (from_zero && step == 0) {
      float* x = level.x.data();
      countWork(level.blocks.lanes(), 2.0, 3.0 * sizeof(float));
      level.blocks.forEach([&](int, std::ptrdiff_t c, const float* k) {
#pragma omp simd
        for (int i = 0; i < kLanes; ++i) x[c + i] = d[c + i] = scale * k[kInverse * kLanes + i] * b[c + i];
      });
    } else {
      const float* x = level.x.data();
      float* next = level.next.data();
      countWork(level.blocks.lanes(), kNetworkFlops + 6.0, 5.0 * sizeof(float));
      level.blocks.forEach([&](int, std::ptrdiff_t c, const float* k) {
        float Lx[kLanes];
        network(level.lattice, k, x + c, Lx);
#pragma omp simd
        for (int i = 0; i < kLanes; ++i) {
          d[c + i] = keep * d[c + i] + scale * k[kInverse * kLanes + i] * (b[c + i] - Lx[i]);
          next[c + i] = x[c + i] + d[c + i];
        }
      });
      if (level.partial) {
        // What is not in a block is in x alone.
        float* to = level.x.data();
        countWork(level.blocks.lanes(), 0.0, 2.0 * sizeof(float));
        level.blocks.forEach([&](int, std::ptrdiff_t c, const float*) { std::copy_n(next + c, kLanes, to + c); });
      } else {
        level.x.swap(level.next);
      }
    }
    fillHalo(level.lattice, level.x);
  }
}

void PressureMultigrid::descend(std::size_t index) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) {
    if (coarsest_cells_.empty()) {
      smooth(level, kCoarsestDegree, true);
      return;
    }
    const auto count = static_cast<Eigen::Index>(coarsest_cells_.size());
    Eigen::VectorXf b(count);
    countWork(static_cast<std::size_t>(count * count), 2.0, sizeof(float));
    for (Eigen::Index i = 0; i < count; ++i) b[i] = level.right[coarsest_cells_[i]];
    const Eigen::VectorXf x = inverse_ * b;
    for (Eigen::Index i = 0; i < count; ++i) level.x[coarsest_cells_[i]] = x[i];
    fillHalo(level.lattice, level.x);
    return;
  }
  if (level.partial) {
    countWork(level.x.size(), 0.0, sizeof(float));
    assignZero(level.x.size(), level.x);
  }
  smooth(level, kSmootherDegree, true);
  residual(level, level.next.data());
  Level& coarse = levels_[index + 1];
  // The operator is scaled by the cell width squared, which doubles twice per level.
  restrictResidual(level.lattice, level.next.data(), coarse.lattice, coarse.planes, 4.0f, coarse.b.data());
  coarse.right = coarse.b.data();
  descend(index + 1);
  for (const Extension& e : coarse.extension) coarse.x[e.to] = 0.5f * (coarse.x[e.a] + coarse.x[e.b]);
  prolongateCells(coarse.lattice, coarse.x.data(), level.lattice, level.planes, level.mask.data(), level.x.data());
  // The extension must not be seen by the coarse operator next time.
  for (const Extension& e : coarse.extension) coarse.x[e.to] = 0.0f;
  fillHalo(level.lattice, level.x);
  smooth(level, kSmootherDegree, false);
}

float* PressureMultigrid::cycle(const float* b) {
  levels_[0].right = b;
  descend(0);
  return levels_[0].x.data();
}

}  // namespace monolith
