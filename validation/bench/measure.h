#pragma once
// The measurements. Each runs in a process of its own: memory starts from nothing, and so do the threads.

#include <functional>

#include "tank_scene.h"

namespace monolith::bench {

// Best rate of a = b + s c over arrays that no cache holds, bytes/s.
double streamBandwidth(int threads);

// One solve from rest.
struct Accuracy {
  bool good = false;
  double tolerance = 0.0;  // the loosest that reaches the error
  double error = 0.0;      // true one of the bodies' accelerations, relative
  double solve_ms = 0.0;   // assembling and solving, fastest
  int iterations = 0;
  char message[200] = "";
};
// tolerance > 0: that one; 0: to be looked for.
Accuracy measureAccuracy(const Case& wanted, double error, double tolerance);

// Times of the median step, while every body is pushed to and fro.
struct StepFigures {
  bool good = false;
  double ms_per_step = 0.0;
  double advection_ms = 0.0, contact_ms = 0.0, geometry_ms = 0.0, solve_ms = 0.0, surface_ms = 0.0, other_ms = 0.0;
  double cpu_ms = 0.0;         // of all threads, mean
  double iterations = 0.0;     // mean
  double liquid_solves = 0.0;  // mean
  double flops = 0.0, streamed = 0.0;  // of the solve's kernels, mean: solve/kernel_work.h; bytes
  double bytes_per_cell = 0.0;         // memory at its peak
  int bodies = 0;
  int contacts = 0;
  char message[200] = "";
};
StepFigures measureSteps(const Case& wanted, double tolerance, int repetitions);

// The result of f, of a trivially copyable type, found by a child process; what it was before if that dies.
template <class Result>
Result inChild(const std::function<Result()>& f);

bool runInChild(const std::function<void(void*)>& f, void* result, std::size_t size);

template <class Result>
Result inChild(const std::function<Result()>& f) {
  Result result{};
  if (!runInChild([&](void* out) { *static_cast<Result*>(out) = f(); }, &result, sizeof(Result))) result = Result{};
  return result;
}

}  // namespace monolith::bench
