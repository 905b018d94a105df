#include "coupling/pressure_regions.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace monolith {

namespace {

// Runs of connected cells along x, joined across the faces between rows (union-find).
class Runs {
 public:
  explicit Runs(const StaggeredCoefficients<double>& c) : c_(c), l_(c.lattice), of_(l_.size, -1) {
    number();
    open_to_air_.assign(parent_.size(), 0);
    forEachRowOfCells([&](std::ptrdiff_t row, int j, int k) { join(row, {0, j, k}); });
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
  template <class Function>
  void forEachRowOfCells(Function&& f) const {
    for (int k = 0; k < l_.n[2]; ++k) {
      for (int j = 0; j < l_.n[1]; ++j) f(l_.index(0, j, k), j, k);
    }
  }

 private:
  // Most rows are liquid from wall to wall, one run, or air, none.
  enum RowKind : std::uint8_t { kMixed, kLiquid, kAir };

  std::uint8_t& kindOf(std::ptrdiff_t row) { return kind_[row / l_.stride[1]]; }

  void number() {
    kind_.assign(l_.size / l_.stride[1] + 1, kAir);
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
      kindOf(row) = some == 0 ? kAir : closed == 0 ? kLiquid : kMixed;
    });
    forEachRowOfCells([&](std::ptrdiff_t row, int, int) {
      if (kindOf(row) == kAir) return;
      if (kindOf(row) == kLiquid) {
        std::fill_n(of_.begin() + row, l_.n[0], count());
        parent_.push_back(count());
        return;
      }
      for (auto cell = row; cell < row + l_.n[0]; ++cell) {
        if (!c_.has_pressure[cell]) continue;
        if (cell > row && of_[cell - 1] >= 0 && c_.open[0][cell] > 0.0) {
          of_[cell] = of_[cell - 1];
        } else {
          of_[cell] = count();
          parent_.push_back(of_[cell]);
        }
      }
    });
  }

  // A row with what is across its low faces, and the high ones where the grid ends.
  void join(std::ptrdiff_t row, const std::array<int, 3>& at) {
    for (int a = 0; a < 3; ++a) {
      const auto s = l_.stride[a];
      for (const int side : {0, 1}) {
        const bool ends = a == 0 || at[a] == l_.n[a] - 1;
        if (side == 1 && (!ends || l_.periodic[a])) continue;
        auto to_other = side == 0 ? -s : s;
        if (a > 0 && at[a] == 0 && side == 0 && l_.periodic[a]) to_other += s * l_.n[a];
        const auto to_face = side == 0 ? 0 : s;
        if (a == 0) {
          joinAlong(row, side, to_face);
        } else if (kindOf(row) == kLiquid && kindOf(row + to_other) == kLiquid && c_.open[a][row + to_face] > 0.0) {
          unite(of_[row], of_[row + to_other]);
        } else if (kindOf(row) != kAir || kindOf(row + to_other) != kAir) {
          int before = -1, beside = -1;
          for (auto cell = row; cell < row + l_.n[0]; ++cell) {
            joinAcross(of_[cell], of_[cell + to_other], c_.open[a][cell + to_face], before, beside);
          }
        }
      }
    }
  }

  // Within a row; its ends are next to each other where the axis is periodic.
  void joinAlong(std::ptrdiff_t row, int side, std::ptrdiff_t to_face) {
    if (kindOf(row) == kAir) return;
    int before = -1, beside = -1;
    const int first = side == 0 ? 0 : l_.n[0] - 1;
    const int last = side == 0 && kindOf(row) == kLiquid ? 0 : l_.n[0] - 1;
    for (int i = first; i <= last; ++i) {
      auto other = row + i + (side == 0 ? -1 : 1);
      if (i == 0 && side == 0 && l_.periodic[0]) other += l_.n[0];
      joinAcross(of_[row + i], of_[other], c_.open[0][row + i + to_face], before, beside);
    }
  }

  // before, beside: the pair that was joined last.
  void joinAcross(int here, int there, double open, int& before, int& beside) {
    if (here == there || !(open > 0.0)) return;
    if (here < 0 || there < 0) {
      open_to_air_[std::max(here, there)] = 1;
    } else if (here != before || there != beside) {
      unite(here, there);
      before = here;
      beside = there;
    }
  }
  void unite(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  const StaggeredCoefficients<double>& c_;
  const Lattice& l_;
  std::vector<int> of_, parent_;
  std::vector<char> open_to_air_;
  std::vector<std::uint8_t> kind_;
};

}  // namespace

std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& c, const BodyRows& rows,
                                                const std::vector<char>& moves) {
  const Lattice& l = c.lattice;
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
  if (std::any_of(regions.begin(), regions.end(), [](const PressureRegion& region) { return region.sealed; })) {
    runs.forEachRowOfCells([&](std::ptrdiff_t row, int, int) {
      for (auto cell = row; cell < row + l.n[0];) {
        const int run = runs.of(cell);
        auto end = cell + 1;
        while (end < row + l.n[0] && runs.of(end) == run) ++end;
        if (run >= 0 && regions[id_of[run]].sealed) {
          PressureRegion& region = regions[id_of[run]];
          region.runs.push_back({static_cast<std::int32_t>(cell), static_cast<std::int32_t>(end)});
          region.cells += static_cast<std::size_t>(end - cell);
        }
        cell = end;
      }
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
