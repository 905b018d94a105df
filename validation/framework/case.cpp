#include "framework/case.h"

namespace monolith {

#define MONOLITH_CASE(function) Case function();
#include "physics/case_list.inc"
#undef MONOLITH_CASE

std::vector<Case> allCases() {
  return {
#define MONOLITH_CASE(function) function(),
#include "physics/case_list.inc"
#undef MONOLITH_CASE
  };
}

Measurement observed(const std::string& phenomenon, bool seen) {
  Measurement m;
  m.quantity = phenomenon;
  m.result = seen ? 1.0 : 0.0;
  m.reference = 1.0;
  m.goal = 0.5;
  m.yes_or_no = true;
  return m;
}

RunFunction atMost(double bound, const std::string& quantity, const RunFunction& run) {
  return [=](const Numerics& numerics, Meter& meter) {
    std::vector<Measurement> out = run(numerics, meter);
    for (Measurement& m : out) {
      if (m.quantity == quantity) m.goal = bound;
    }
    return out;
  };
}

void addSweep(const std::string& variant, const Sweep& sweep, const RunFunction& run, std::vector<Variant>& out) {
  if (sweep.cells.empty()) out.push_back({variant, sweep.base, true, run});
  for (const double cells : sweep.cells) {
    Numerics numerics = sweep.base;
    numerics.cells_across = cells;
    out.push_back({variant, numerics, true, run});
  }
  for (const double step : sweep.steps) {
    if (step == sweep.base.dt) continue;
    Numerics numerics = sweep.base;
    numerics.dt = step;
    out.push_back({variant, numerics, false, run});
  }
  for (const double tolerance : sweep.tolerances) {
    if (tolerance == sweep.base.tolerance) continue;
    Numerics numerics = sweep.base;
    numerics.tolerance = tolerance;
    out.push_back({variant, numerics, false, run});
  }
  if (sweep.fractions) {
    Numerics numerics = sweep.base;
    numerics.discretisation = Discretisation::kFractions;
    out.push_back({variant, numerics, false, run});
  }
}

}  // namespace monolith
