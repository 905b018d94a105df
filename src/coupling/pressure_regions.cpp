#include "coupling/pressure_regions.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "solve/connected_runs.h"
#include "solve/disjoint_sets.h"

namespace monolith {

namespace {

// Of a run of cells along x, those next to a wall of the tank.
long cellsAtWalls(const Lattice& l, std::ptrdiff_t begin, std::ptrdiff_t end) {
  const std::array<int, 3> first = l.cell(begin);
  for (const int a : {1, 2}) {
    if (!l.periodic[a] && (first[a] == 0 || first[a] == l.n[a] - 1)) return static_cast<long>(end - begin);
  }
  if (l.periodic[0]) return 0;
  return (first[0] == 0 ? 1 : 0) + (first[0] + (end - begin) == l.n[0] ? 1 : 0);
}

void findDrifts(const Lattice& l, const BodyRows& rows, const BodyCoordinates& unknowns, const ConnectedRuns& runs,
                const std::vector<int>& id_of, std::vector<PressureRegion>& regions) {
  // Regions, and behind them free bodies, by what they are joined to.
  const auto count = static_cast<int>(regions.size());
  const auto bodies = static_cast<int>(unknowns.bodies());
  DisjointSets joined(count + bodies);
  std::vector<char> moves(bodies, 0);
  for (const BodyCoordinates::Assembly& assembly : unknowns.assemblies()) {
    if (!assembly.adrift) continue;
    for (const int b : assembly.bodies) {
      moves[b] = 1;
      joined.unite(count + assembly.bodies.front(), count + b);
    }
  }
  std::vector<long> cells(joined.count(), 0), held(joined.count(), 0);
  for (const BodyRow& row : rows.divergence) {
    const int run = runs.of(row.sample);
    if (run < 0) continue;
    if (moves[row.body]) {
      joined.unite(count + row.body, id_of[run]);
    } else {
      ++held[id_of[run]];
    }
  }
  runs.forEachRun([&](int run, std::ptrdiff_t begin, std::ptrdiff_t end) {
    cells[id_of[run]] += static_cast<long>(end - begin);
    held[id_of[run]] += cellsAtWalls(l, begin, end);
  });
  for (int id = 0; id < count; ++id) {
    const int to = joined.root(id);
    if (to == id) continue;
    cells[to] += cells[id];
    held[to] += held[id];
  }
  std::vector<int> drift(joined.count(), -1);
  int drifts = 0;
  for (int id = 0; id < count; ++id) {
    const int to = joined.root(id);
    // As much as half the base of a cube.
    const double little = 0.5 * std::pow(static_cast<double>(cells[to]), 2.0 / 3.0);
    if (static_cast<double>(held[to]) >= little) continue;
    if (drift[to] < 0) drift[to] = drifts++;
    regions[id].drift = drift[to];
  }
}

}  // namespace

std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& c, const BodyRows& rows,
                                                const BodyCoordinates& unknowns) {
  ConnectedRuns runs(c.lattice, c.has_pressure, {c.open(0), c.open(1), c.open(2)});
  std::vector<int> id_of;
  std::vector<PressureRegion> regions(runs.numberRegions(id_of));
  for (PressureRegion& region : regions) region.sealed = true;
  for (int run = 0; run < runs.count(); ++run) {
    if (runs.openToOthers(run)) regions[id_of[run]].sealed = false;
  }
  findDrifts(c.lattice, rows, unknowns, runs, id_of, regions);
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
  struct Push {
    std::vector<Vector6d> sum;  // of each body
    std::vector<double> size;   // of its terms
  };
  const Push none{std::vector<Vector6d>(unknowns.bodies(), Vector6d::Zero()),
                  std::vector<double>(unknowns.bodies(), 0.0)};
  std::map<int, Push> push;  // of regions
  for (const BodyRow& row : rows.divergence) {
    const int run = runs.of(row.sample);
    const int id = run < 0 ? -1 : id_of[run];
    if (id < 0 || !regions[id].sealed) continue;
    Push& entry = push.try_emplace(id, none).first->second;
    entry.sum[row.body] += row.coefficient;
    entry.size[row.body] += row.coefficient.cwiseAbs().maxCoeff();
  }
  for (auto& region : regions) region.null_mode = region.sealed;
  for (const auto& [id, entry] : push) {
    const Eigen::VectorXd felt = unknowns.gatherForces(entry.sum);
    for (const BodyCoordinates::Assembly& assembly : unknowns.assemblies()) {
      double size = 0.0;
      for (const int b : assembly.bodies) size += entry.size[b];
      const double most = felt.segment(assembly.first, assembly.count).cwiseAbs().maxCoeff();
      if (most > 1e-9 * size) regions[id].null_mode = false;
    }
  }
  return regions;
}

}  // namespace monolith
