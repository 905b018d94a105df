#include "framework/runner.h"

#include <algorithm>
#include <cmath>

#include "framework/meter.h"

namespace monolith {
namespace {

bool same(const Numerics& a, const Numerics& b) {
  return a.cells_across == b.cells_across && a.dt == b.dt && a.tolerance == b.tolerance && a.solver == b.solver &&
         a.discretisation == b.discretisation;
}

}  // namespace

const char* toString(SolverName name) {
  switch (name) {
    case SolverName::kFast:
      return "fast";
    case SolverName::kDirect:
      return "direct";
    case SolverName::kReference:
      return "reference";
  }
  return "";
}

const char* toString(Discretisation discretisation) {
  return discretisation == Discretisation::kFitted ? "fitted" : "fractions";
}

bool Run::good() const {
  if (!failure.empty()) return false;
  return !judged || std::all_of(measurements.begin(), measurements.end(),
                                [](const Measurement& m) { return m.goal == 0.0 || std::abs(m.error()) <= m.goal; });
}

std::vector<Variant> variantsOf(const Case& what, Extent extent, const Overrides& overrides) {
  std::vector<Variant> out;
  for (Variant variant : what.variants(extent)) {
    Numerics& numerics = variant.numerics;
    const Numerics own = numerics;
    numerics.cells_across = overrides.cells_across.value_or(own.cells_across);
    numerics.dt = overrides.dt.value_or(own.dt);
    numerics.tolerance = overrides.tolerance.value_or(own.tolerance);
    numerics.solver = overrides.solver.value_or(own.solver);
    numerics.discretisation = overrides.discretisation.value_or(own.discretisation);
    if (!same(numerics, own)) variant.judged = false;
    const auto known = std::find_if(out.begin(), out.end(), [&](const Variant& v) {
      return v.name == variant.name && same(v.numerics, variant.numerics);
    });
    if (known == out.end()) {
      out.push_back(variant);
    } else {
      known->judged = known->judged || variant.judged;
    }
  }
  return out;
}

Run execute(const Case& what, const Variant& variant, const std::function<void(double)>& progress) {
  Run run;
  run.case_name = what.name;
  run.variant = variant.name;
  run.numerics = variant.numerics;
  run.judged = variant.judged;
  run.steady = what.steady;
  Meter meter(progress);
  try {
    run.measurements = variant.run(variant.numerics, meter);
  } catch (const RunFailed& failed) {
    run.failure = failed.what();
  } catch (const SceneError& error) {
    run.failure = error.what();
  }
  run.cpu_s = meter.cpu();
  run.wall_s = meter.wall();
  run.simulated_s = meter.simulated();
  run.substeps = meter.substeps();
  run.iterations = meter.iterations();
  if (meter.dt() > 0.0) run.numerics.dt = meter.dt();
  if (meter.cellsAcross() > 0.0) run.numerics.cells_across = meter.cellsAcross();
  return run;
}

double observedOrder(const std::vector<Run>& runs, const ExpectedOrder& what) {
  // Every run of the variant may be in the sweep that is meant: the one with the most runs.
  std::vector<std::pair<double, double>> points;
  for (const Run& base : runs) {
    std::vector<std::pair<double, double>> found;
    for (const Run& run : runs) {
      if (base.variant != what.variant || run.variant != what.variant || !run.failure.empty()) continue;
      Numerics expected = base.numerics;
      if (what.in_time || run.steady) expected.dt = run.numerics.dt;
      if (!what.in_time) expected.cells_across = run.numerics.cells_across;
      if (!same(expected, run.numerics)) continue;
      for (const Measurement& m : run.measurements) {
        if (m.quantity != what.quantity || m.error() == 0.0) continue;
        const double fineness = what.in_time ? run.numerics.dt : 1.0 / run.numerics.cells_across;
        found.emplace_back(std::log(fineness), std::log(std::abs(m.error())));
      }
    }
    if (found.size() > points.size()) points.swap(found);
  }
  const double n = static_cast<double>(points.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const auto& [px, py] : points) {
    x += px / n;
    y += py / n;
  }
  for (const auto& [px, py] : points) {
    xx += (px - x) * (px - x);
    xy += (px - x) * (py - y);
  }
  return points.size() < 2 ? std::nan("") : xy / xx;
}

}  // namespace monolith
