#include "framework/meter.h"

#include <chrono>
#include <ctime>

namespace monolith {
namespace {

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Meter::Meter(std::function<void(double)> progress) : progress_(std::move(progress)) { restart(); }

void Meter::restart() {
  cpu_start_ = cpuSeconds();
  wall_start_ = wallSeconds();
}

double Meter::cpu() const { return cpuSeconds() - cpu_start_; }
double Meter::wall() const { return wallSeconds() - wall_start_; }

StepReport Meter::step(Simulation& simulation) {
  const StepReport report = simulation.step();
  if (!report.committed()) {
    throw RunFailed("step " + std::to_string(report.step + 1) + " failed, " + toString(report.status) + ": " +
                    report.message);
  }
  dt_ = simulation.scene().time_step;
  simulated_ += dt_;
  ++steps_;
  substeps_ += report.substeps;
  iterations_ += report.iterations;
  return report;
}

void Meter::advance(Simulation& simulation, double time, const std::function<void(const StepReport&)>& after) {
  const double start = simulation.time();
  const double dt = simulation.scene().time_step;
  while (simulation.time() < time - 1e-6 * dt) {
    const StepReport report = step(simulation);
    if (after) after(report);
    progress((simulation.time() - start) / (time - start));
  }
}

void Meter::progress(double part) const {
  if (progress_) progress_(part);
}

}  // namespace monolith
