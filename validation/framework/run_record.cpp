#include "framework/run_record.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

namespace monolith {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) >= 0x20) {
      out += c;
    }
  }
  return out + '"';
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string outputOf(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string out;
  char buffer[256];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get()) != nullptr) out += buffer;
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

class Line {
 public:
  void add(const std::string& key, const std::string& json) {
    text_ += (text_.empty() ? "{" : ", ") + quoted(key) + ": " + json;
  }
  std::string end() const { return text_ + "}\n"; }

 private:
  std::string text_;
};

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
    Line line;
    line.add("case", quoted(run.case_name));
    line.add("variant", quoted(run.variant));
    line.add("quantity", m ? quoted(m->quantity) : "null");
    line.add("reference", m ? number(m->reference) : "null");
    line.add("result", m ? number(m->result) : "null");
    line.add("error", m ? number(m->error()) : "null");
    line.add("goal", m && m->goal > 0.0 ? number(m->goal) : "null");
    line.add("judged", run.judged ? "true" : "false");
    line.add("cells_across", number(run.numerics.cells_across));
    line.add("dt", number(run.numerics.dt));
    line.add("tolerance", number(run.numerics.tolerance));
    line.add("solver", quoted(toString(run.numerics.solver)));
    line.add("discretisation", quoted(toString(run.numerics.discretisation)));
    line.add("steady", run.steady ? "true" : "false");
    line.add("cpu_s", number(run.cpu_s));
    line.add("wall_s", number(run.wall_s));
    line.add("simulated_s", number(run.simulated_s));
    line.add("substeps", std::to_string(run.substeps));
    line.add("iterations", std::to_string(run.iterations));
    if (!run.failure.empty()) line.add("failure", quoted(run.failure));
    line.add("commit", quoted(origin.commit));
    line.add("machine", quoted(origin.machine));
    out += line.end();
  };
  for (const Measurement& m : run.measurements) add(&m);
  if (run.measurements.empty()) add(nullptr);
  return out;
}

}  // namespace monolith
