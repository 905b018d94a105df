#pragma once
// Runs variants and keeps what came of each.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/case.h"

namespace monolith {

// What the command line replaces in every variant. The goals of variants that it changes do not count.
struct Overrides {
  std::optional<double> cells_across;
  std::optional<double> dt;
  std::optional<double> tolerance;
  std::optional<SolverName> solver;
  std::optional<Discretisation> discretisation;
};

struct Run {
  std::string case_name;
  std::string variant;
  Numerics numerics;  // dt: the output step that was used
  bool judged = true;
  bool steady = false;
  std::vector<Measurement> measurements;
  std::string failure;  // why there are none
  double cpu_s = 0.0;
  double wall_s = 0.0;
  double simulated_s = 0.0;
  long substeps = 0;
  long iterations = 0;

  // No failure, and every goal met if they count.
  bool good() const;
};

// Variants of a case with the overrides applied, without those that become the same by it.
std::vector<Variant> variantsOf(const Case& what, Extent extent, const Overrides& overrides);

Run execute(const Case& what, const Variant& variant, const std::function<void(double)>& progress = {});

// Slope of log |error| over the logarithm of the cell width (or of dt, in_time) by least squares, over the runs of one
// variant that differ in nothing else. NaN for less than two of them.
double observedOrder(const std::vector<Run>& runs, const ExpectedOrder& what);

const char* toString(SolverName name);
const char* toString(Discretisation discretisation);

}  // namespace monolith
