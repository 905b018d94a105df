#include "report.h"

#include <cmath>

#include "framework/json_object.h"
#include "framework/runner.h"

namespace monolith::bench {
void printHead(std::FILE* to) {
  std::fprintf(
      to,
      "Times in ms of the median step; iter: Krylov iterations a step, x: against the first size; solves: with the\n"
      "whole liquid; B/cel: memory at its peak; flop, strm: operations and bytes that the solve's kernels stream, a\n"
      "step and cell; bw: bytes streamed a second, from caches or memory, part of what this machine's memory gives;\n"
      "scale: against the first number of threads; touch: against the same bodies a cell apart.\n"
      "%5s %3s %8s %6s %8s %9s %8s %7s | %8s %6s %6s %6s %8s %6s %6s | %7s %5s %6s %6s %5s %6s %6s %7s %5s %6s %6s "
      "%8s\n",
      "cells", "thr", "nu dt/h2", "bodies", "contacts", "solver", "tol", "error", "ms/step", "advect", "contct", "geom",
      "solve", "surf", "other", "cpu ms", "iter", "x", "solves", "B/cel", "flop", "strm", "Gflop/s", "bw", "scale",
      "touch", "speedup");
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
  const double cells = std::pow(c.size, 3);
  std::fprintf(
      to,
      "%8.1e %7.1e | %8.1f %6.1f %6.1f %6.1f %8.1f %6.1f %6.1f | %7.1f %5.1f %6.2f %6.1f %5.0f %6.0f %6.0f %7.1f "
      "%5.2f %6.2f ",
      row.accuracy.tolerance, row.accuracy.error, s.ms_per_step, s.advection_ms, s.contact_ms, s.geometry_ms,
      s.solve_ms, s.surface_ms, s.other_ms, s.cpu_ms, s.iterations, row.iteration_growth, s.liquid_solves,
      s.bytes_per_cell, s.flops / cells, s.streamed / cells, 1e-6 * s.flops / s.solve_ms, row.bandwidth_share,
      row.thread_speedup);
  const auto printFactor = [&](double factor, const char* format) {
    if (factor > 0.0) {
      std::fprintf(to, format, factor);
    } else {
      std::fprintf(to, "%6s ", "-");
    }
  };
  printFactor(row.contact_factor, "%6.2f ");
  printFactor(row.speedup, "%8.1f");
  std::fprintf(to, "\n");
}

std::string toJson(const Row& row, const Origin& origin) {
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
  out.add("solver", toString(c.solver));
  out.addRaw("good", good ? "true" : "false");
  out.add("message", row.accuracy.good ? s.message : row.accuracy.message);
  out.add("tolerance", row.accuracy.tolerance);
  out.add("true_error", row.accuracy.error);
  out.add("ms_per_step", good ? s.ms_per_step : NAN);
  out.add("cpu_ms", s.cpu_ms);
  out.addRaw("stage_ms", stages.str());
  out.add("iterations", s.iterations);
  out.add("iteration_growth", row.iteration_growth);
  out.add("liquid_solves", s.liquid_solves);
  out.add("bytes_per_cell", s.bytes_per_cell);
  out.add("flops_per_cell", s.flops / std::pow(c.size, 3));
  out.add("streamed_bytes_per_cell", s.streamed / std::pow(c.size, 3));
  out.add("bandwidth", row.bandwidth);
  out.add("bandwidth_share", row.bandwidth_share);
  out.add("thread_speedup", row.thread_speedup);
  out.add("contact_factor", row.contact_factor > 0.0 ? row.contact_factor : NAN);
  out.add("solve_from_rest_ms", row.accuracy.solve_ms);
  out.add("speedup", row.speedup > 0.0 ? row.speedup : NAN);
  out.add("against", row.against);
  out.add("against_ms", row.against_ms > 0.0 ? row.against_ms : NAN);
  out.add("against_error", row.against_ms > 0.0 ? row.against_error : NAN);
  out.add("against_tolerance", row.against_ms > 0.0 ? row.against_tolerance : NAN);
  out.add("commit", origin.commit);
  out.add("machine", origin.machine);
  return out.str();
}

}  // namespace monolith::bench
