#include "solve/connected_runs.h"

#include <algorithm>
#include <numeric>

namespace monolith {
namespace {

// Of neighbouring cells in turn: most joints are the last one again.
void addJoint(int here, int there, double open, std::vector<std::pair<int, int>>& out) {
  if (here == there || !(open > 0.0)) return;
  const std::pair<int, int> joint(std::max(here, there), std::min(here, there));
  if (out.empty() || out.back() != joint) out.push_back(joint);
}

}  // namespace

ConnectedRuns::ConnectedRuns(const Lattice& lattice, const std::vector<std::uint8_t>& has,
                             const std::array<OpenParts<double>, 3>& open)
    : l_(lattice) {
  const Cells cells{has, open};
  const std::vector<int> first = number(cells);
  sets_ = DisjointSets(first.back());
  open_to_others_.assign(sets_.count(), 0);
  join(cells);
}

int ConnectedRuns::numberRegions(std::vector<int>& region_of) {
  region_of.assign(count(), -1);
  int regions = 0;
  for (int run = 0; run < count(); ++run) {
    const int first = sets_.root(run);
    if (region_of[first] < 0) region_of[first] = regions++;
    region_of[run] = region_of[first];
  }
  return regions;
}

std::vector<int> ConnectedRuns::number(const Cells& cells) {
  const auto rows = static_cast<std::ptrdiff_t>(l_.size) / l_.stride[1];
  kind_.assign(rows, kNone);
  std::vector<int> first(rows + 1, 0);
  const auto goesOn = [&](std::ptrdiff_t cell) {
    return cells.has[cell - 1] && cells.has[cell] && cells.open[0][cell] > 0.0;
  };
  forEachRow(l_, [&](std::ptrdiff_t row, int j, int k) {
    if (j >= l_.n[1] || k >= l_.n[2]) return;
    const std::uint8_t* has = cells.has.data() + row;
    const OpenParts<double> open = cells.open[0] + row;
    int some = has[0] != 0, closed = has[0] == 0;
#pragma omp simd reduction(+ : some, closed)
    for (int i = 1; i < l_.n[0]; ++i) {
      some += has[i] != 0;
      closed += !(has[i] != 0 && open[i] > 0.0);
    }
    const auto at = row / l_.stride[1];
    kind_[at] = some == 0 ? kNone : closed == 0 ? kAll : kMixed;
    int runs = has[0] != 0;
    if (kind_[at] == kMixed) {
      for (auto cell = row + 1; cell < row + l_.n[0]; ++cell) runs += has[cell - row] && !goesOn(cell);
    }
    first[at + 1] = runs;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  of_.resize(l_.size);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (std::ptrdiff_t at = 0; at < rows; ++at) {
    int* of = of_.data() + at * l_.stride[1];
    std::fill_n(of, l_.stride[1], -1);
    if (kind_[at] == kNone) continue;
    const auto row = at * l_.stride[1] + Lattice::kLowHalo;
    int run = first[at] - 1;
    for (auto cell = row; cell < row + l_.n[0]; ++cell) {
      if (!cells.has[cell]) continue;
      if (cell == row || !goesOn(cell)) ++run;
      of_[cell] = run;
    }
  }
  return first;
}

void ConnectedRuns::join(const Cells& cells) {
  std::vector<std::vector<Joint>> planes(l_.n[2]);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int k = 0; k < l_.n[2]; ++k) {
    for (int j = 0; j < l_.n[1]; ++j) findJoints(cells, l_.index(0, j, k), {0, j, k}, planes[k]);
  }
  for (const auto& plane : planes) {
    for (const auto& [here, there] : plane) {
      if (there == kToOthers) {
        open_to_others_[here] = 1;
      } else {
        sets_.unite(here, there);
      }
    }
  }
}

void ConnectedRuns::findJoints(const Cells& cells, std::ptrdiff_t row, const std::array<int, 3>& at,
                               std::vector<Joint>& out) const {
  for (int a = 0; a < 3; ++a) {
    const auto s = l_.stride[a];
    for (const int side : {0, 1}) {
      const bool ends = a == 0 || at[a] == l_.n[a] - 1;
      if (side == 1 && (!ends || l_.periodic[a])) continue;
      auto to_other = side == 0 ? -s : s;
      if (a > 0 && at[a] == 0 && side == 0 && l_.periodic[a]) to_other += s * l_.n[a];
      const auto to_face = side == 0 ? 0 : s;
      if (a == 0) {
        findJointsAlong(cells, row, side, to_face, out);
      } else if (kindOf(row) == kAll && kindOf(row + to_other) == kAll && cells.open[a][row + to_face] > 0.0) {
        out.emplace_back(of_[row], of_[row + to_other]);
      } else if (kindOf(row) != kNone || kindOf(row + to_other) != kNone) {
        for (auto cell = row; cell < row + l_.n[0]; ++cell) {
          addJoint(of_[cell], of_[cell + to_other], cells.open[a][cell + to_face], out);
        }
      }
    }
  }
}

void ConnectedRuns::findJointsAlong(const Cells& cells, std::ptrdiff_t row, int side, std::ptrdiff_t to_face,
                                    std::vector<Joint>& out) const {
  if (kindOf(row) == kNone) return;
  const int first = side == 0 ? 0 : l_.n[0] - 1;
  const int last = side == 0 && kindOf(row) == kAll ? 0 : l_.n[0] - 1;
  for (int i = first; i <= last; ++i) {
    auto other = row + i + (side == 0 ? -1 : 1);
    if (i == 0 && side == 0 && l_.periodic[0]) other += l_.n[0];
    addJoint(of_[row + i], of_[other], cells.open[0][row + i + to_face], out);
  }
}

}  // namespace monolith
