#pragma once
// Runs as JSON, one object a line and measurement. Keys: case, variant, quantity, reference, result, error
// (relative), goal, yes_or_no, judged, cells_across, dt (s), tolerance, solver, discretisation, steady, cpu_s,
// wall_s, simulated_s, substeps, iterations, commit, machine. A run that failed has one line with "failure" and null
// for what it did not measure.

#include <string>

#include "framework/runner.h"

namespace monolith {

struct Origin {
  std::string commit;   // of the source, "-changed" if it has uncommitted changes; empty: unknown
  std::string machine;  // processor and number of cores
};
Origin findOrigin();

std::string toJson(const Run& run, const Origin& origin);

}  // namespace monolith
