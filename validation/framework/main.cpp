// ./tank validate: see usage in options.cpp. Exit code: 0 every goal met, 1 not, 2 the command is wrong.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "framework/options.h"
#include "framework/run_progress.h"
#include "framework/run_record.h"

namespace monolith {
namespace {

std::string shown(const Run& run) {
  char text[160];
  std::snprintf(text, sizeof text, "%s, %g across, dt %.3g s, tolerance %.0e%s%s", run.variant.c_str(),
                run.numerics.cells_across, run.numerics.dt, run.numerics.tolerance,
                run.numerics.solver == SolverName::kFast ? "" : ", direct or reference",
                run.numerics.discretisation == Discretisation::kFitted ? "" : ", fractions");
  return text;
}

void print(const Run& run) {
  std::printf("%s: %s\n", run.case_name.c_str(), shown(run).c_str());
  if (!run.failure.empty()) std::printf("    FAILED %s\n", run.failure.c_str());
  for (const Measurement& m : run.measurements) {
    std::printf("    %-34s %12.6g  reference %12.6g  error %+8.3f %%", m.quantity.c_str(), m.result, m.reference,
                100.0 * m.error());
    if (m.goal > 0.0 && run.judged) {
      std::printf("  goal %g %%  %s", 100.0 * m.goal, std::abs(m.error()) <= m.goal ? "met" : "MISSED");
    }
    std::printf("\n");
  }
  std::printf("    %.2f s of CPU, %.2f s of wall time, %g s simulated, %ld sub-steps, %ld iterations\n", run.cpu_s,
              run.wall_s, run.simulated_s, run.substeps, run.iterations);
  std::fflush(stdout);
}

std::vector<Case> chosenCases(const std::vector<std::string>& names) {
  const std::vector<Case> all = allCases();
  if (names.empty()) return all;
  std::vector<Case> out;
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Case& c) { return c.name == name; });
    if (found == all.end()) throw WrongCommand("unknown case '" + name + "'; --list shows them");
    out.push_back(*found);
  }
  return out;
}

int validate(const ValidationOptions& options) {
  const std::vector<Case> cases = chosenCases(options.cases);
  if (options.list) {
    for (const Case& c : cases) {
      std::printf("%-20s %s (%zu runs, quick %zu)\n", c.name.c_str(), c.title.c_str(),
                  variantsOf(c, Extent::kFull, options.overrides).size(),
                  variantsOf(c, Extent::kQuick, options.overrides).size());
    }
    return 0;
  }
  std::ofstream json;
  if (!options.json.empty()) {
    json.open(options.json);
    if (!json) throw WrongCommand("--json '" + options.json + "': cannot be written");
  }
  const Origin origin = findOrigin();
  std::size_t total = 0;
  for (const Case& c : cases) total += variantsOf(c, options.extent, options.overrides).size();
  RunProgress progress(static_cast<int>(total));
  int missed = 0;
  for (const Case& c : cases) {
    for (const Variant& variant : variantsOf(c, options.extent, options.overrides)) {
      progress.begin(c.name + ": " + variant.name);
      const Run run = execute(c, variant, [&](double part) { progress.show(part); });
      progress.end();
      print(run);
      if (json.is_open()) json << toJson(run, origin) << std::flush;
      if (!run.good()) ++missed;
    }
  }
  std::printf("%zu runs, %d with a goal missed\n", total, missed);
  return missed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace monolith

int main(int argc, char** argv) {
  using namespace monolith;
  try {
    const ValidationOptions options = parseValidationOptions(std::vector<std::string>(argv + 1, argv + argc));
    if (options.help) {
      std::fputs(kValidationUsage, stdout);
      return 0;
    }
    return validate(options);
  } catch (const WrongCommand& wrong) {
    std::fprintf(stderr, "validate: %s\n%s", wrong.what(), kValidationUsage);
    return 2;
  }
}
