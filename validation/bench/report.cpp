#include "report.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "options.h"

namespace monolith::bench {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "\"";
}

class JsonObject {
 public:
  void add(const std::string& key, double value) {
    std::ostringstream text;
    text.precision(6);
    if (std::isfinite(value)) {
      text << value;
    } else {
      text << "null";
    }
    addRaw(key, text.str());
  }
  void add(const std::string& key, const std::string& value) { addRaw(key, quoted(value)); }
  void addRaw(const std::string& key, const std::string& value) {
    text_ += (text_.empty() ? "" : ", ") + quoted(key) + ": " + value;
  }
  std::string str() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

}  // namespace

void printHead(std::FILE* to) {
  std::fprintf(
      to,
      "Times in ms of the median step; iter: Krylov iterations a step, x: against the first size; solves: with\n"
      "the whole liquid; B/cell: memory at its peak; bw: bandwidth of the solve if each iteration went through\n"
      "that memory once, part of this machine's; scale: against the first number of threads.\n"
      "%5s %3s %8s %6s %8s %9s %8s %7s | %8s %6s %6s %6s %8s %6s %6s | %7s %5s %6s %6s %5s %5s %8s %8s\n",
      "cells", "thr", "nu dt/h2", "bodies", "contacts", "solver", "tol", "error", "ms/step", "advect", "contct", "geom",
      "solve", "surf", "other", "cpu ms", "iter", "x", "solves", "B/cel", "bw", "scale", "speedup");
}

void printRow(const Row& row, std::FILE* to) {
  const Case& c = row.wanted;
  const StepFigures& s = row.steps;
  std::fprintf(to, "%5d %3d %8.3g %6d %8d %9s ", c.size, c.threads, c.viscous_number, s.bodies, s.contacts,
               toString(c.solver));
  if (!row.accuracy.good || !s.good) {
    std::fprintf(to, "failed: %s\n", row.accuracy.good ? s.message : row.accuracy.message);
    return;
  }
  std::fprintf(to,
               "%8.1e %7.1e | %8.1f %6.1f %6.1f %6.1f %8.1f %6.1f %6.1f | %7.1f %5.1f %6.2f %6.1f %5.0f %5.2f %8.2f ",
               row.accuracy.tolerance, row.accuracy.error, s.ms_per_step, s.advection_ms, s.contact_ms, s.geometry_ms,
               s.solve_ms, s.surface_ms, s.other_ms, s.cpu_ms, s.iterations, row.iteration_growth, s.liquid_solves,
               s.bytes_per_cell, row.bandwidth_share, row.thread_speedup);
  if (row.speedup > 0.0) {
    std::fprintf(to, "%8.1f\n", row.speedup);
  } else {
    std::fprintf(to, "%8s\n", "-");
  }
}

std::string toJson(const Row& row, const std::string& commit, const std::string& machine) {
  const Case& c = row.wanted;
  const StepFigures& s = row.steps;
  const bool good = row.accuracy.good && s.good;
  JsonObject stages;
  stages.add("advection", s.advection_ms);
  stages.add("contact", s.contact_ms);
  stages.add("geometry", s.geometry_ms);
  stages.add("solve", s.solve_ms);
  stages.add("surface", s.surface_ms);
  stages.add("other", s.other_ms);
  JsonObject out;
  out.add("size", c.size);
  out.add("threads", c.threads);
  out.add("viscous_number", c.viscous_number);
  out.add("bodies", s.bodies);
  out.add("contacts", s.contacts);
  out.add("fill", c.fill);
  out.add("solver", std::string(toString(c.solver)));
  out.addRaw("good", good ? "true" : "false");
  out.add("message", std::string(row.accuracy.good ? s.message : row.accuracy.message));
  out.add("tolerance", row.accuracy.tolerance);
  out.add("true_error", row.accuracy.error);
  out.add("ms_per_step", good ? s.ms_per_step : NAN);
  out.add("cpu_ms", s.cpu_ms);
  out.addRaw("stage_ms", stages.str());
  out.add("iterations", s.iterations);
  out.add("iteration_growth", row.iteration_growth);
  out.add("liquid_solves", s.liquid_solves);
  out.add("bytes_per_cell", s.bytes_per_cell);
  out.add("bandwidth", row.bandwidth);
  out.add("bandwidth_share", row.bandwidth_share);
  out.add("thread_speedup", row.thread_speedup);
  out.add("solve_from_rest_ms", row.accuracy.solve_ms);
  out.add("speedup", row.speedup > 0.0 ? row.speedup : NAN);
  out.add("against", row.against);
  out.add("against_ms", row.against_ms > 0.0 ? row.against_ms : NAN);
  out.add("against_error", row.against_ms > 0.0 ? row.against_error : NAN);
  out.add("against_tolerance", row.against_ms > 0.0 ? row.against_tolerance : NAN);
  out.add("commit", commit);
  out.add("machine", machine);
  return out.str();
}

std::string commitOf(const std::string& folder) {
  std::string out;
  if (std::FILE* git = popen(("git -C '" + folder + "' describe --always --dirty 2>/dev/null").c_str(), "r")) {
    char text[100];
    if (std::fgets(text, sizeof(text), git) != nullptr) out = text;
    pclose(git);
  }
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out.empty() ? "unknown" : out;
}

std::string machineName() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, model = "unknown processor";
  while (std::getline(info, line)) {
    if (line.compare(0, 10, "model name") != 0) continue;
    model = line.substr(line.find(':') + 2);
    break;
  }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

}  // namespace monolith::bench
