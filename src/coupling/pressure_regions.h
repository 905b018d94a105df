#pragma once
// Connected regions of cells with pressure. A region without a free surface is sealed: its pressure is free up to a
// constant, and its solids must not change its volume.

#include <cstdint>
#include <numeric>
#include <vector>

#include "coupling/body_coordinates.h"
#include "coupling/body_rows.h"

namespace monolith {

struct PressureRegion {
  // Cells next to each other along x.
  struct Run {
    std::int32_t begin, end;
  };

  bool sealed = false;     // no face towards the air
  bool null_mode = false;  // sealed, and no free body feels the constant: it is in the operator's null space
  // Regions that free bodies join drift together, under one number from 0 on, where few of their cells are at walls or
  // at bodies that are not free; -1: held.
  int drift = -1;
  std::vector<Run> runs;   // of regions that are sealed or adrift
  std::size_t cells = 0;   // in them

  // f(begin, end) for every run, shared among threads.
  template <class RunFunction>
  void forEachRun(RunFunction&& f) const {
#pragma omp parallel for schedule(static) if (cells >= kSizeWorthSharing)
    for (std::size_t i = 0; i < runs.size(); ++i) f(runs[i].begin, runs[i].end);
  }
  // Sum of f(begin, end): the same bits at any number of threads.
  template <class RunFunction>
  double sum(RunFunction&& f) const {
    std::vector<double> sums(runs.size());
#pragma omp parallel for schedule(static) if (cells >= kSizeWorthSharing)
    for (std::size_t i = 0; i < runs.size(); ++i) sums[i] = f(runs[i].begin, runs[i].end);
    return std::accumulate(sums.begin(), sums.end(), 0.0);
  }
};

// `unknowns`: of the bodies' motion.
std::vector<PressureRegion> findPressureRegions(const StaggeredCoefficients<double>& coefficients, const BodyRows& rows,
                                                const BodyCoordinates& unknowns);

}  // namespace monolith
