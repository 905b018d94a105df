#include "framework/run_record.h"

#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <thread>

#include "framework/json_object.h"

namespace monolith {
namespace {

std::string outputOf(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string out;
  char buffer[256];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get()) != nullptr) out += buffer;
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

}  // namespace

Origin findOrigin() {
  Origin origin;
  const std::string git = "git -C '" MONOLITH_SOURCE_DIR "' ";
  origin.commit = outputOf(git + "rev-parse --short HEAD 2>/dev/null");
  if (!origin.commit.empty() && !outputOf(git + "status --porcelain --untracked-files=no 2>/dev/null").empty()) {
    origin.commit += "-changed";
  }
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    origin.machine = line.substr(line.find(':') + 2) + ", ";
    break;
  }
  origin.machine += std::to_string(std::thread::hardware_concurrency()) + " cores";
  return origin;
}

std::string toJson(const Run& run, const Origin& origin) {
  std::string out;
  const auto add = [&](const Measurement* m) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    JsonObject line;
    line.add("case", run.case_name);
    line.add("variant", run.variant);
    if (m) {
      line.add("quantity", m->quantity);
    } else {
      line.addRaw("quantity", "null");
    }
    line.add("reference", m ? m->reference : kNone);
    line.add("result", m ? m->result : kNone);
    line.add("error", m ? m->error() : kNone);
    line.add("goal", m && m->goal > 0.0 ? m->goal : kNone);
    line.addRaw("yes_or_no", m && m->yes_or_no ? "true" : "false");
    line.addRaw("judged", run.judged ? "true" : "false");
    line.add("cells_across", run.numerics.cells_across);
    line.add("dt", run.numerics.dt);
    line.add("tolerance", run.numerics.tolerance);
    line.add("solver", toString(run.numerics.solver));
    line.add("discretisation", toString(run.numerics.discretisation));
    line.addRaw("steady", run.steady ? "true" : "false");
    line.add("cpu_s", run.cpu_s);
    line.add("wall_s", run.wall_s);
    line.add("simulated_s", run.simulated_s);
    line.add("substeps", static_cast<double>(run.substeps));
    line.add("iterations", static_cast<double>(run.iterations));
    if (!run.failure.empty()) line.add("failure", run.failure);
    line.add("commit", origin.commit);
    line.add("machine", origin.machine);
    out += line.str() + "\n";
  };
  for (const Measurement& m : run.measurements) add(&m);
  if (run.measurements.empty()) add(nullptr);
  return out;
}

}  // namespace monolith
