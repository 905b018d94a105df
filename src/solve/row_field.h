#pragma once
// A field of a lattice that is the same along most x-rows as in others of their plane: rows that are alike, halo and
// all, are kept once. Of coefficients that geometry makes only those at boundaries take memory. It is written by planes
// and read by rows.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include "solve/lattice.h"

namespace monolith {

template <class Value>
class RowField {
 public:
  bool empty() const { return rows_.empty(); }
  void clear() { *this = RowField(); }

  // What row(), operator[] and the planes' numbers mean; entries are zero at first, and stay what they are where the
  // lattice is the one that it was.
  void reshape(const Lattice& lattice) {
    if (!rows_.empty() && lattice_.n == lattice.n && lattice_.periodic == lattice.periodic) return;
    lattice_ = lattice;
    setZero();
  }
  void setZero() {
    const auto none = std::make_shared<std::vector<Value>>(lattice_.stride[1], Value(0));
    planes_.assign(planeCount(), none);
    rows_.assign(planeCount() * rowCount(), none->data());
  }

  // Entry `index` and those after it, to the end of its row.
  const Value* row(std::ptrdiff_t index) const {
    const std::ptrdiff_t at = index / lattice_.stride[1];
    return rows_[at] + (index - at * lattice_.stride[1]);
  }
  Value operator[](std::ptrdiff_t index) const { return *row(index); }

  // The plane of cells or faces k with its halo, lattice.stride[2] entries; different planes may be packed at once.
  void unpackPlane(int k, std::vector<Value>& plane) const {
    const std::size_t width = lattice_.stride[1];
    plane.resize(lattice_.stride[2]);
    const Value* const* rows = rows_.data() + rowCount() * (k + Lattice::kLowHalo);
    for (std::size_t j = 0; j < rowCount(); ++j) std::copy_n(rows[j], width, plane.data() + j * width);
  }
  // Its periodic images within the plane are filled first.
  void packPlane(int k, std::vector<Value>& plane) {
    fillImages(plane);
    const std::size_t width = lattice_.stride[1], bytes = width * sizeof(Value);
    std::vector<std::size_t> number(rowCount()), first;  // of the rows that differ: each row's, and where they are
    for (std::size_t j = 0; j < rowCount(); ++j) {
      const Value* row = plane.data() + j * width;
      const auto alike = [&](std::size_t other) { return std::memcmp(row, plane.data() + other * width, bytes) == 0; };
      const std::size_t lately = first.size() - std::min<std::size_t>(first.size(), kCompared);
      std::size_t found = first.size();
      while (found > lately && !alike(first[found - 1])) --found;
      if (found == lately) {
        first.push_back(j);
        found = first.size();
      }
      number[j] = found - 1;
    }
    auto values = std::make_shared<std::vector<Value>>();
    values->reserve(first.size() * width);
    for (const std::size_t j : first) {
      values->insert(values->end(), plane.data() + j * width, plane.data() + (j + 1) * width);
    }
    const Value** rows = rows_.data() + rowCount() * (k + Lattice::kLowHalo);
    for (std::size_t j = 0; j < rowCount(); ++j) rows[j] = values->data() + number[j] * width;
    planes_[k + Lattice::kLowHalo] = std::move(values);
  }
  // After all of them have been packed: planes that are images of others.
  void shareImages() {
    if (!lattice_.periodic[2]) return;
    const int n = lattice_.n[2];
    for (int g = 1; g <= Lattice::kLowHalo; ++g) sharePlane(-g, ((-g % n) + n) % n);
    for (int g = 0; g < Lattice::kHighHalo; ++g) sharePlane(n + g, g % n);
  }

  // f(index, value): all entries that are not images from those of another field, or of this one.
  template <class Function>
  void transform(const RowField& from, Function&& f) {
    const Lattice& l = from.lattice_;
    reshape(l);
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l.faceEnd(2); ++k) {
      std::vector<Value> plane;
      from.unpackPlane(k, plane);
      for (int j = 0; j < l.faceEnd(1); ++j) {
        const std::ptrdiff_t row = l.index(0, j, k);
        Value* values = plane.data() + (row - l.planeBegin(k));
        for (int i = 0; i < l.faceEnd(0); ++i) values[i] = f(row + i, values[i]);
      }
      packPlane(k, plane);
    }
    shareImages();
  }
  void pack(const Lattice& lattice, const std::vector<Value>& field) {
    reshape(lattice);
    transform(*this, [&](std::ptrdiff_t i, Value) { return field[i]; });
  }

  friend bool operator==(const RowField& a, const RowField& b) {
    if (a.rows_.size() != b.rows_.size() || a.lattice_.stride != b.lattice_.stride) return false;
    for (std::size_t r = 0; r < a.rows_.size(); ++r) {
      if (!std::equal(a.rows_[r], a.rows_[r] + a.lattice_.stride[1], b.rows_[r])) return false;
    }
    return true;
  }

 private:
  static constexpr std::size_t kCompared = 4;  // rows that one may be like

  std::size_t rowCount() const { return lattice_.stride[2] / lattice_.stride[1]; }  // of a plane
  std::size_t planeCount() const { return lattice_.size / lattice_.stride[2]; }

  void sharePlane(int to, int from) {
    const std::size_t count = rowCount();
    planes_[to + Lattice::kLowHalo] = planes_[from + Lattice::kLowHalo];
    std::copy_n(rows_.data() + count * (from + Lattice::kLowHalo), count,
                rows_.data() + count * (to + Lattice::kLowHalo));
  }
  void fillImages(std::vector<Value>& plane) const {
    for (int axis = 0; axis < 2; ++axis) {
      if (!lattice_.periodic[axis]) continue;
      const int other = 1 - axis;
      const std::ptrdiff_t step = lattice_.stride[axis], across = lattice_.stride[other], n = lattice_.n[axis];
      const std::ptrdiff_t end = lattice_.n[other] + Lattice::kLowHalo + Lattice::kHighHalo;
      for (std::ptrdiff_t p = 0; p < end; ++p) {
        Value* line = plane.data() + p * across + Lattice::kLowHalo * step;
        for (int g = 1; g <= Lattice::kLowHalo; ++g) line[-g * step] = line[(n - g) * step];
        for (int g = 0; g < Lattice::kHighHalo; ++g) line[(n + g) * step] = line[g * step];
      }
    }
  }

  Lattice lattice_;
  std::vector<std::shared_ptr<const std::vector<Value>>> planes_;  // the rows that differ
  std::vector<const Value*> rows_;                                 // of every plane
};

// One for the faces of each axis.
template <class Value>
using FaceRows = std::array<RowField<Value>, 3>;

}  // namespace monolith
