#include "coupling/pressure_regions.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace monolith {

namespace {

// Runs of connected cells along x, joined across the faces between rows (union-find). What every row needs is found by
// all threads; numbers and joints are in the order of the rows.
class Runs {
 public:
  explicit Runs(const StaggeredCoefficients<double>& c) : c_(c), l_(c.lattice) {
    const std::vector<int> first = number();
    parent_.resize(first.back());
    std::iota(parent_.begin(), parent_.end(), 0);
    open_to_air_.assign(parent_.size(), 0);
    join();
  }

  int count() const { return static_cast<int>(parent_.size()); }
  // The run of a cell; -1: no pressure there.
  int of(std::ptrdiff_t cell) const { return of_[cell]; }
  bool openToAir(int run) const { return open_to_air_[run] != 0; }
  // The first run of a region stands for it: regions are numbered in the order of their first cells.
  int root(int run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }
  // f(run, begin, end), in the order of the cells.
  template <class Function>
  void forEachRun(Function&& f) const {
    for (int k = 0; k < l_.n[2]; ++k) {
      for (int j = 0; j < l_.n[1]; ++j) {
        const auto row = l_.index(0, j, k), row_end = row + l_.n[0];
        if (kind_[row / l_.stride[1]] == kAir) continue;
        if (kind_[row / l_.stride[1]] == kLiquid) {
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
  // Most rows are liquid from wall to wall, one run, or air, none.
  enum RowKind : std::uint8_t { kMixed, kLiquid, kAir };
  static constexpr int kToAir = -1;
  using Joint = std::pair<int, int>;  // two runs; or one and kToAir

  RowKind kindOf(std::ptrdiff_t row) const { return kind_[row / l_.stride[1]]; }

  // Numbers the runs; returns the first of each row, and how many there are.
  std::vector<int> number() {
    const auto rows = static_cast<std::ptrdiff_t>(l_.size) / l_.stride[1];
    kind_.assign(rows, kAir);
    std::vector<int> first(rows + 1, 0);
    const auto goesOn = [&](std::ptrdiff_t cell) {
      return c_.has_pressure[cell - 1] && c_.has_pressure[cell] && c_.open[0][cell] > 0.0;
    };
    forEachRow(l_, [&](std::ptrdiff_t row, int j, int k) {
      if (j >= l_.n[1] || k >= l_.n[2]) return;
      const std::uint8_t* has = c_.has_pressure.data() + row;
      const double* open = c_.open[0].data() + row;
      int some = has[0] != 0, closed = has[0] == 0;
#pragma omp simd reduction(+ : some, closed)
      for (int i = 1; i < l_.n[0]; ++i) {
        some += has[i] != 0;
        closed += !(has[i] != 0 && open[i] > 0.0);
      }
      const auto at = row / l_.stride[1];
      kind_[at] = some == 0 ? kAir : closed == 0 ? kLiquid : kMixed;
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
      if (kind_[at] == kAir) continue;
      const auto row = at * l_.stride[1] + Lattice::kLowHalo;
      int run = first[at] - 1;
      for (auto cell = row; cell < row + l_.n[0]; ++cell) {
        if (!c_.has_pressure[cell]) continue;
        if (cell == row || !goesOn(cell)) ++run;
        of_[cell] = run;
      }
    }
    return first;
  }

  void join() {
    std::vector<std::vector<Joint>> planes(l_.n[2]);
#pragma omp parallel for schedule(static, kPlanesInTurn)
    for (int k = 0; k < l_.n[2]; ++k) {
      for (int j = 0; j < l_.n[1]; ++j) findJoints(l_.index(0, j, k), {0, j, k}, planes[k]);
    }
    for (const auto& plane : planes) {
      for (const auto& [here, there] : plane) {
        if (there == kToAir) {
          open_to_air_[here] = 1;
        } else {
          unite(here, there);
        }
      }
    }
  }

  // Of a row with what is across its low faces, and the high ones where the grid ends.
  void findJoints(std::ptrdiff_t row, const std::array<int, 3>& at, std::vector<Joint>& out) const {
    for (int a = 0; a < 3; ++a) {
      const auto s = l_.stride[a];
      for (const int side : {0, 1}) {
        const bool ends = a == 0 || at[a] == l_.n[a] - 1;
        if (side == 1 && (!ends || l_.periodic[a])) continue;
        auto to_other = side == 0 ? -s : s;
        if (a > 0 && at[a] == 0 && side == 0 && l_.periodic[a]) to_other += s * l_.n[a];
        const auto to_face = side == 0 ? 0 : s;
        if (a == 0) {
          findJointsAlong(row, side, to_face, out);
        } else if (kindOf(row) == kLiquid && kindOf(row + to_other) == kLiquid && c_.open[a][row + to_face] > 0.0) {
          out.emplace_back(of_[row], of_[row + to_other]);
        } else if (kindOf(row) != kAir || kindOf(row + to_other) != kAir) {
          for (auto cell = row; cell < row + l_.n[0]; ++cell) {
            addJoint(of_[cell], of_[cell + to_other], c_.open[a][cell + to_face], out);
          }
        }
      }
    }
  }

  // Within a row; its ends are next to each other where the axis is periodic.
  void findJointsAlong(std::ptrdiff_t row, int side, std::ptrdiff_t to_face, std::vector<Joint>& out) const {
    if (kindOf(row) == kAir) return;
    const int first = side == 0 ? 0 : l_.n[0] - 1;
    const int last = side == 0 && kindOf(row) == kLiquid ? 0 : l_.n[0] - 1;
    for (int i = first; i <= last; ++i) {
      auto other = row + i + (side == 0 ? -1 : 1);
      if (i == 0 && side == 0 && l_.periodic[0]) other += l_.n[0];
      addJoint(of_[row + i], of_[other], c_.open[0][row + i + to_face], out);
    }
  }

  // Of neighbouring cells in turn: most joints are the last one again.
  static void addJoint(int here, int there, double open, std::vector<Joint>& out) {
    if (here == there || !(open > 0.0)) return;
    const Joint joint(std::max(here, there), std::min(here, there));
    if (out.empty() || out.back() != joint) out.push_back(joint);
  }
  void unite(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  const StaggeredCoefficients<double>& c_;
  const Lattice& l_;
  Eigen::ArrayXi of_;  // resized, it is not written by one thread first
  std::vector<int> parent_;
  std::vector<char> open_to_air_;
  std::vector<RowKind> kind_;  // of every row of the lattice
};

// Of a run of cells along x, those next to a wall of the tank.
long cellsAtWalls(const Lattice& l, std::ptrdiff_t begin, std::ptrdiff_t end) {
  const std::array<int, 3> first = l.cell(begin);
  for (const int a : {1, 2}) {
    if (!l.periodic[a] && (first[a] == 0 || first[a] == l.n[a] - 1)) return static_cast<long>(end - begin);
  }
  if (l.periodic[0]) return 0;
  return (first[0] == 0 ? 1 : 0) + (first[0] + (end - begin) == l.n[0] ? 1 : 0);
}

void findDrifts(const Lattice& l, const BodyRows& rows, const std::vector<char>& moves, const Runs& runs,
                const std::vector<int>& id_of, std::vector<PressureRegion>& regions) {
  // Regions, and behind them free bodies, by what they are joined to.
  const std::size_t count = regions.size();
  std::vector<std::size_t> joined(count + moves.size());
  std::iota(joined.begin(), joined.end(), 0);
  const auto root = [&](std::size_t i) {
    while (joined[i] != i) i = joined[i] = joined[joined[i]];
    return i;
  };
  std::vector<long> cells(joined.size(), 0), held(joined.size(), 0);
  for (const BodyRow& row : rows.divergence) {
    const int run = runs.of(row.sample);
    if (run < 0) continue;
    if (moves[row.body]) {
      joined[root(count + row.body)] = root(id_of[run]);
    } else {
      ++held[id_of[run]];
    }
  }
  runs.forEachRun([&](int run, std::ptrdiff_t begin, std::ptrdiff_t end) {
    cells[id_of[run]] += static_cast<long>(end - begin);
    held[id_of[run]] += cellsAtWalls(l, begin, end);
  });
  for (std::size_t id = 0; id < count; ++id) {
    const std::size_t to = root(id);
    if (to == id) continue;
    cells[to] += cells[id];
    held[to] += held[id];
  }
  std::vector<int> drift(joined.size(), -1);
  int drifts = 0;
  for (std::size_t id = 0; id < count; ++id) {
    const std::size_t to = root(id);
    // As much as half the base of a cube.
    const double little = 0.5 * std::pow(static_cast<double>(cells[to]), 2.0 / 3.0);
    if (static_cast<double>(held[to]) >= little) continue;
    if (drift[to] < 0) drift[to] = drifts++;
    regions[id].drift = drift[to];
  }
}

}  // namespace

std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& c, const BodyRows& rows,
                                                const std::vector<char>& moves) {
  Runs runs(c);
  std::vector<int> id_of(runs.count(), -1);
  std::vector<PressureRegion> regions;
  for (int run = 0; run < runs.count(); ++run) {
    const int first = runs.root(run);
    if (id_of[first] < 0) {
      id_of[first] = static_cast<int>(regions.size());
      regions.emplace_back();
      regions.back().sealed = true;
    }
    id_of[run] = id_of[first];
    if (runs.openToAir(run)) regions[id_of[run]].sealed = false;
  }
  findDrifts(c.lattice, rows, moves, runs, id_of, regions);
  const auto wanted = [](const PressureRegion& region) { return region.sealed || region.drift >= 0; };
  if (std::any_of(regions.begin(), regions.end(), wanted)) {
    runs.forEachRun([&](int run, std::ptrdiff_t begin, std::ptrdiff_t end) {
      PressureRegion& region = regions[id_of[run]];
      if (!wanted(region)) return;
      region.runs.push_back({static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)});
      region.cells += static_cast<std::size_t>(end - begin);
    });
  }
  // The constant of a sealed region pushes a body by the sum of its rows there.
  std::map<std::pair<int, int>, std::pair<Vector6d, double>> push;  // region, body -> sum, size of its terms
  for (const BodyRow& row : rows.divergence) {
    const int run = runs.of(row.sample);
    const int id = run < 0 ? -1 : id_of[run];
    if (id < 0 || !regions[id].sealed || !moves[row.body]) continue;
    auto& entry = push.try_emplace({id, row.body}, Vector6d::Zero(), 0.0).first->second;
    entry.first += row.coefficient;
    entry.second += row.coefficient.cwiseAbs().maxCoeff();
  }
  for (auto& region : regions) region.null_mode = region.sealed;
  for (const auto& [key, entry] : push) {
    if (entry.first.cwiseAbs().maxCoeff() > 1e-9 * entry.second) regions[key.first].null_mode = false;
  }
  return regions;
}

}  // namespace monolith
