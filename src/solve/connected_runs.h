#pragma once
// Cells that are connected through open faces, as runs along x that are joined across the faces between rows. What
// every row needs is found by all threads; numbers and joints are in the order of the rows.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "solve/disjoint_sets.h"
#include "solve/lattice.h"
#include "solve/staggered_operator.h"

namespace monolith {

class ConnectedRuns {
 public:
  // Of the cells where `has` is not 0, through faces where `open` is more than 0. They must outlive the constructor.
  ConnectedRuns(const Lattice& lattice, const std::vector<std::uint8_t>& has,
                const std::array<OpenParts<double>, 3>& open);

  int count() const { return sets_.count(); }
  // The run of a cell; -1: it is none of them.
  int of(std::ptrdiff_t cell) const { return of_[cell]; }
  // Whether a face leads from it to a cell that is none of them.
  bool openToOthers(int run) const { return open_to_others_[run] != 0; }
  // Of each run the number of its region, in the order of their first cells; returns how many there are.
  int numberRegions(std::vector<int>& region_of);
  // f(run, begin, end), in the order of the cells.
  template <class Function>
  void forEachRun(Function&& f) const {
    for (int k = 0; k < l_.n[2]; ++k) {
      for (int j = 0; j < l_.n[1]; ++j) {
        const auto row = l_.index(0, j, k), row_end = row + l_.n[0];
        if (kindOf(row) == kNone) continue;
        if (kindOf(row) == kAll) {
          f(of_[row], row, row_end);
          continue;
        }
        for (auto cell = row; cell < row_end;) {
          auto end = cell + 1;
          while (end < row_end && of_[end] == of_[cell]) ++end;
          if (of_[cell] >= 0) f(of_[cell], cell, end);
          cell = end;
        }
      }
    }
  }

 private:
  // Most rows are one run from wall to wall, or have none.
  enum RowKind : std::uint8_t { kMixed, kAll, kNone };
  static constexpr int kToOthers = -1;
  using Joint = std::pair<int, int>;  // two runs; or one and kToOthers
  struct Cells {
    const std::vector<std::uint8_t>& has;
    const std::array<OpenParts<double>, 3>& open;
  };

  RowKind kindOf(std::ptrdiff_t row) const { return kind_[row / l_.stride[1]]; }
  // Numbers the runs; returns the first of each row, and how many there are.
  std::vector<int> number(const Cells& cells);
  void join(const Cells& cells);
  // Of a row with what is across its low faces, and the high ones where the grid ends.
  void findJoints(const Cells& cells, std::ptrdiff_t row, const std::array<int, 3>& at, std::vector<Joint>& out) const;
  // Within a row; its ends are next to each other where the axis is periodic.
  void findJointsAlong(const Cells& cells, std::ptrdiff_t row, int side, std::ptrdiff_t to_face,
                       std::vector<Joint>& out) const;

  Lattice l_;
  Eigen::ArrayXi of_;  // resized, it is not written by one thread first
  DisjointSets sets_;
  std::vector<char> open_to_others_;
  std::vector<RowKind> kind_;  // of every row of the lattice
};

}  // namespace monolith
