#pragma once
// Index space that all fields of a staggered grid share: n[0] x n[1] x n[2] cells, x fastest, with two layers of halo
// around them, as a cubic next to a wall needs them, so that a stencil never branches. The face, edge or cell called
// (i, j, k) is the one at the low side (faces), low corner (edges) or inside (cells) of cell (i, j, k).
//
// Along an axis with walls faces run from 0 to n inclusive; along a periodic one from 0 to n - 1.
//
// x-rows are as long as whole groups of kLanes cells with their halo, so that kernels may work on such groups from the
// first cell or face of a row on and never touch the next row's (stencil_blocks.h). What is beyond the halo stays zero.

#include <array>
#include <cstddef>
#include <vector>

namespace monolith {

constexpr int kLanes = 8;

struct Lattice {
  static constexpr int kLowHalo = 2;
  static constexpr int kHighHalo = 2;

  std::array<int, 3> n{};
  std::array<bool, 3> periodic{};
  std::array<std::ptrdiff_t, 3> stride{};
  std::size_t size = 0;

  Lattice() = default;
  Lattice(const std::array<int, 3>& cells, const std::array<bool, 3>& periodic_axes)
      : n(cells), periodic(periodic_axes) {
    const std::ptrdiff_t halo = kLowHalo + kHighHalo;
    const std::ptrdiff_t width = (n[0] + kLanes - 1) / kLanes * kLanes + halo;
    stride = {1, width, width * (n[1] + halo)};
    size = static_cast<std::size_t>(stride[2]) * static_cast<std::size_t>(n[2] + halo);
  }

  std::ptrdiff_t index(int i, int j, int k) const {
    return (i + kLowHalo) + stride[1] * (j + kLowHalo) + stride[2] * (k + kLowHalo);
  }
  // (i, j, k) of an index.
  std::array<int, 3> cell(std::ptrdiff_t index) const {
    return {static_cast<int>(index % stride[1]) - kLowHalo,
            static_cast<int>(index / stride[1] % (stride[2] / stride[1])) - kLowHalo,
            static_cast<int>(index / stride[2]) - kLowHalo};
  }
  // One past the last face along an axis.
  int faceEnd(int axis) const { return periodic[axis] ? n[axis] : n[axis] + 1; }
  // Place along an axis that one in a periodic image stands for; along an axis with walls the place itself.
  int wrapped(int axis, int at) const { return periodic[axis] ? ((at % n[axis]) + n[axis]) % n[axis] : at; }
  // Index of what (i, j, k), perhaps in a periodic image, stands for; -1 outside the tank. faces: the axes along which
  // it is a face or the end of an edge, of which there is one more than cells.
  std::ptrdiff_t indexInTank(std::array<int, 3> at, const std::array<bool, 3>& faces = {}) const {
    for (int a = 0; a < 3; ++a) {
      at[a] = wrapped(a, at[a]);
      if (at[a] < 0 || at[a] >= (faces[a] ? faceEnd(a) : n[a])) return -1;
    }
    return index(at[0], at[1], at[2]);
  }
  // Where the plane of cells or faces k begins in a field, halo and all.
  std::ptrdiff_t planeBegin(int k) const { return stride[2] * (k + kLowHalo); }
  bool anyPeriodic() const { return periodic[0] || periodic[1] || periodic[2]; }
};

// Planes of cells or faces, k from `first` to before `end`: those that hold all unknowns, beyond which nobody looks.
// Loops over them in equal parts give each thread what it has of stencils (stencil_blocks.h), which stays in its cache.
struct Planes {
  int first = 0, end = 0;
};
inline Planes allPlanes(const Lattice& l) { return {0, l.faceEnd(2)}; }

// Smaller lattices are not worth waking a second thread for; nor are these if there is much to do for each cell.
constexpr std::size_t kSizeWorthSharing = 5000;
constexpr std::size_t kHeavySizeWorthSharing = 2000;
// Threads take planes in turn, so many at a time: liquid may fill only the lowest.
constexpr int kPlanesInTurn = 4;

// Calls f(row_start, j, k) for every x-row of faces (the range that covers all cells, faces and edges); f sees
// rows of faceEnd(0) entries. Rows are shared among threads by k, so f may write its own row only.
template <class RowFunction>
void forEachRow(const Lattice& lattice, RowFunction&& f) {
  const int end_j = lattice.faceEnd(1);
  const int end_k = lattice.faceEnd(2);
#pragma omp parallel for schedule(static, kPlanesInTurn) if (lattice.size >= kSizeWorthSharing)
  for (int k = 0; k < end_k; ++k) {
    for (int j = 0; j < end_j; ++j) {
      f(lattice.index(0, j, k), j, k);
    }
  }
}

// The same where there is much to do for each cell, and for some far more than for others: whoever is free takes the
// next plane.
template <class RowFunction>
void forEachHeavyRow(const Lattice& lattice, RowFunction&& f) {
  const int end_j = lattice.faceEnd(1);
  const int end_k = lattice.faceEnd(2);
#pragma omp parallel for schedule(dynamic) if (lattice.size >= kHeavySizeWorthSharing)
  for (int k = 0; k < end_k; ++k) {
    for (int j = 0; j < end_j; ++j) f(lattice.index(0, j, k), j, k);
  }
}

// Copies the periodic images into the halo; nothing along axes with walls.
template <class Value>
void fillHalo(const Lattice& lattice, Value* field) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!lattice.periodic[axis]) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    const auto base = lattice.index(0, 0, 0);
    const auto shift = lattice.stride[axis] * lattice.n[axis];
    for (int q = -Lattice::kLowHalo; q < lattice.n[c] + Lattice::kHighHalo; ++q) {
      for (int p = -Lattice::kLowHalo; p < lattice.n[b] + Lattice::kHighHalo; ++p) {
        const auto row = base + p * lattice.stride[b] + q * lattice.stride[c];
        for (int g = 1; g <= Lattice::kLowHalo; ++g) {
          field[row - g * lattice.stride[axis]] = field[row - g * lattice.stride[axis] + shift];
        }
        for (int g = 0; g < Lattice::kHighHalo; ++g) {
          field[row + shift + g * lattice.stride[axis]] = field[row + g * lattice.stride[axis]];
        }
      }
    }
  }
}

template <class Value>
void fillHalo(const Lattice& lattice, std::vector<Value>& field) {
  fillHalo(lattice, field.data());
}

// Fills the halo of a cell field: beyond walls with the nearest value inside, along periodic axes with the images.
template <class Value>
void extendIntoHalo(const Lattice& lattice, std::vector<Value>& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    if (lattice.periodic[axis]) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    const auto s = lattice.stride[axis];
    const int n = lattice.n[axis];
    for (int q = -Lattice::kLowHalo; q < lattice.n[c] + Lattice::kHighHalo; ++q) {
      for (int p = -Lattice::kLowHalo; p < lattice.n[b] + Lattice::kHighHalo; ++p) {
        Value* row = cells.data() + lattice.index(0, 0, 0) + p * lattice.stride[b] + q * lattice.stride[c];
        for (int g = 1; g <= Lattice::kLowHalo; ++g) row[-g * s] = row[0];
        for (int g = 0; g < Lattice::kHighHalo; ++g) row[(n + g) * s] = row[(n - 1) * s];
      }
    }
  }
  fillHalo(lattice, cells);
}

// Zeroes the periodic images, so that sums over the whole array count each unknown once.
template <class Value>
void clearHalo(const Lattice& lattice, Value* field) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!lattice.periodic[axis]) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    const auto base = lattice.index(0, 0, 0);
    for (int q = -Lattice::kLowHalo; q < lattice.n[c] + Lattice::kHighHalo; ++q) {
      for (int p = -Lattice::kLowHalo; p < lattice.n[b] + Lattice::kHighHalo; ++p) {
        const auto row = base + p * lattice.stride[b] + q * lattice.stride[c];
        for (int g = 1; g <= Lattice::kLowHalo; ++g) field[row - g * lattice.stride[axis]] = Value(0);
        for (int g = 0; g < Lattice::kHighHalo; ++g) {
          field[row + (lattice.n[axis] + g) * lattice.stride[axis]] = Value(0);
        }
      }
    }
  }
}

template <class Value>
void clearHalo(const Lattice& lattice, std::vector<Value>& field) {
  clearHalo(lattice, field.data());
}

}  // namespace monolith
