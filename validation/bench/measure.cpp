#include "measure.h"

#include <omp.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>

#include "coupling/coupled_system.h"
#include "coupling/sticking_liquid.h"
#include "framework/meter.h"
#include "rigid/contact.h"
#include "simulation/contact_laws.h"
#include "simulation/liquid_state.h"
#include "simulation/simulation.h"
#include "solve/kernel_work.h"

namespace monolith::bench {
namespace {

constexpr double kTight = 1e-10;  // tolerance of the solve that counts as exact
constexpr int kWarmUp = 2;        // steps before those that are timed
constexpr double kPush = 0.1;     // of its weight, on each body
constexpr double kLoosest = 0.1, kTightest = 1e-9;
const double kGrade = std::sqrt(10.0);  // between the tolerances that are tried

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// A line of /proc/self/status, in bytes.
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.compare(0, key.size(), key) == 0) return 1024.0 * std::atof(line.c_str() + key.size() + 1);
  }
  return 0.0;
}

template <std::size_t size>
void copyMessage(const std::string& text, char (&to)[size]) {
  std::snprintf(to, size, "%s", text.c_str());
}

// The first step of a scene, as the simulation makes it, to be solved as often as wanted.
struct FirstStep {
  explicit FirstStep(const Scene& s)
      : scene(s),
        grid(makeGrid(s.tank, s.liquid)),
        surface(grid, s.liquid.fill_level, s.liquid.boxes),
        system(grid, s.solver.name, s.solver.coupling, s.solver.discretisation) {
    system.setStickingViscosity(stickingViscosity(s.liquid.density, std::sqrt(s.gravity.norm() * grid.h), grid.h));
    for (const BodyDescription& body : s.bodies) bodies.push_back(makeRigidBody(body, 0.5 * grid.h));
    SolidSampler(grid).sample(bodies, sampled);
    surface.extendIntoSolids(sampled.cell_distance, sampled.distance);
    TankWalls walls;
    walls.inside = Eigen::AlignedBox3d(s.tank.origin, s.tank.origin + s.tank.size);
    const double reach = 2.0 * s.gravity.norm() * s.time_step * s.time_step + 0.05 * grid.h;
    contacts = ContactDetector(bodies, walls).detect(bodies, reach);
    for (const RigidBody& body : bodies) twists.push_back(freeTwist(body, s.gravity, Wrench(), s.time_step));
    for (int a = 0; a < 3; ++a) {
      free_velocity[a].assign(grid.lattice.size, s.gravity[a] * s.time_step);
      start.velocity[a].assign(grid.lattice.size, 0.0);
    }
    start.pressure = hydrostaticPressure(grid, surface, s.liquid.density, s.gravity);
    start.twists.assign(bodies.size(), Vector6d::Zero());
    start.liquid.assign(bodies.size(), Wrench());
    start.contact.assign(bodies.size(), Wrench());
  }

  void assemble() {
    solids = sampled;
    system.assemble(solids, bodies, surface.distance(), scene.liquid.density, scene.liquid.dynamic_viscosity,
                    scene.time_step);
  }
  CoupledReport solve(double tolerance) {
    state = start;
    CoupledOptions options;
    options.tolerance = tolerance;
    options.maximum_iterations = scene.solver.maximum_iterations;
    FaceField<double> right = free_velocity;
    return system.solve(right, twists, contacts, ContactLaws(scene).of(contacts), {}, scene.gravity, options, state);
  }

  Scene scene;
  MacGrid grid;
  FreeSurface surface;
  CoupledSystem system;
  std::vector<RigidBody> bodies;
  SolidFractions sampled, solids;
  std::vector<Contact> contacts;
  std::vector<Vector6d> twists;
  FaceField<double> free_velocity;
  CoupledState start, state;
};

// Largest difference of the changes of velocity, of body and rim, relative to the largest there is, or to gravity's
// hundredth part where all bodies rest.
double accelerationError(const FirstStep& step, const std::vector<Vector6d>& exact) {
  double error = 0.0, largest = 0.01 * step.scene.gravity.norm() * step.scene.time_step;
  for (std::size_t b = 0; b < exact.size(); ++b) {
    const double radius = 0.5 * step.bodies[b].distance->bounds().sizes().maxCoeff();
    const Vector6d miss = step.state.twists[b] - exact[b];
    error = std::max({error, miss.head<3>().norm(), radius * miss.tail<3>().norm()});
    largest = std::max(largest, exact[b].head<3>().norm());
  }
  return error / largest;
}

void search(FirstStep& step, const std::vector<Vector6d>& exact, double goal, double fixed, Accuracy& out) {
  const auto attempt = [&](double tolerance) {
    const double start = seconds();
    const CoupledReport report = step.solve(tolerance);
    const double ms = 1e3 * (seconds() - start);
    const double error = accelerationError(step, exact);
    const bool reached = report.status == SolveStatus::kConverged && (fixed > 0.0 || error <= goal);
    if (reached) {
      out.good = true;
      out.tolerance = tolerance;
      out.error = error;
      out.solve_ms = ms;
      out.iterations = report.iterations;
    } else if (report.status != SolveStatus::kConverged) {
      copyMessage(report.message, out.message);
    }
    return reached;
  };
  if (fixed > 0.0) {
    attempt(fixed);
    return;
  }
  double tolerance = 1e-4;
  if (attempt(tolerance)) {
    while (tolerance < kLoosest && attempt(tolerance * kGrade)) tolerance *= kGrade;
    return;
  }
  while (tolerance > kTightest && !attempt(tolerance /= kGrade)) {
  }
  if (!out.good && out.message[0] == '\0') copyMessage("no tolerance reaches the error", out.message);
}

}  // namespace

bool runInChild(const std::function<void(void*)>& f, void* result, std::size_t size) {
  void* shared = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return false;
  std::fflush(nullptr);
  std::memcpy(shared, result, size);
  const pid_t child = fork();
  if (child == 0) {
    try {
      f(shared);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "bench: %s\n", error.what());
      _exit(1);
    }
    _exit(0);
  }
  int status = 1;
  const bool good = child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (good) std::memcpy(result, shared, size);
  munmap(shared, size);
  return good;
}

double streamBandwidth(int threads) {
  constexpr std::ptrdiff_t kSize = 8 << 20;
  omp_set_num_threads(threads);
  std::vector<double> a(kSize), b(kSize), c(kSize);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < kSize; ++i) b[i] = c[i] = 1e-3 * static_cast<double>(i);
  double best = std::numeric_limits<double>::max();
  for (int pass = 0; pass < 8; ++pass) {
    const double start = seconds();
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t i = 0; i < kSize; ++i) a[i] = b[i] + 0.5 * c[i];
    best = std::min(best, seconds() - start);
  }
  return 3.0 * sizeof(double) * static_cast<double>(kSize) / best;
}

Accuracy measureAccuracy(const Case& wanted, double error, double tolerance) {
  Accuracy out;
  omp_set_num_threads(wanted.threads);
  Case tight = wanted;
  tight.solver = SolverName::kFast;
  FirstStep truth(tankScene(tight, kTight));
  truth.assemble();
  const CoupledReport report = truth.solve(kTight);
  if (report.status != SolveStatus::kConverged) {
    copyMessage("the solve that counts as exact: " + report.message, out.message);
    return out;
  }
  FirstStep step(tankScene(wanted, error));
  const double start = seconds();
  step.assemble();
  const double assembled_ms = 1e3 * (seconds() - start);
  search(step, truth.state.twists, error, tolerance, out);
  out.solve_ms += assembled_ms;
  return out;
}

StepFigures measureSteps(const Case& wanted, double tolerance, int repetitions) {
  StepFigures out;
  const Scene scene = tankScene(wanted, tolerance);
  const double baseline = memory("VmRSS:");
  Simulation simulation(scene);
  double cpu = 0.0;
  std::vector<StepReport> reports;
  for (int i = -kWarmUp; i < repetitions; ++i) {
    // In another direction each time: a thick liquid would be steady after a step, and leave the solve nothing to do.
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double angle = 0.5 * M_PI * (i + static_cast<int>(b));
      Wrench push;
      push.force =
          kPush * scene.bodies[b].mass * scene.gravity.norm() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
      simulation.setWrench(static_cast<int>(b), push);
    }
    if (i == 0) {
      cpu = cpuSeconds();
      kernelWork() = KernelWork();
    }
    const StepReport report = simulation.step();
    if (!report.committed()) {
      copyMessage(report.message, out.message);
      return out;
    }
    if (i >= 0) reports.push_back(report);
  }
  out.cpu_ms = 1e3 * (cpuSeconds() - cpu) / repetitions;
  out.flops = kernelWork().flops / repetitions;
  out.streamed = kernelWork().bytes / repetitions;
  out.bytes_per_cell = (memory("VmHWM:") - baseline) / std::pow(wanted.size, 3);
  out.bodies = static_cast<int>(scene.bodies.size());
  out.contacts = reports.back().model.contacts;
  for (const StepReport& report : reports) {
    out.iterations += static_cast<double>(report.iterations) / repetitions;
    out.liquid_solves += static_cast<double>(report.liquid_solves) / repetitions;
  }
  std::sort(reports.begin(), reports.end(),
            [](const StepReport& a, const StepReport& b) { return a.times.total < b.times.total; });
  const StageTimes& t = reports[(reports.size() - 1) / 2].times;
  out.ms_per_step = 1e3 * t.total;
  out.advection_ms = 1e3 * t.advection;
  out.contact_ms = 1e3 * t.contact;
  out.geometry_ms = 1e3 * t.geometry;
  out.solve_ms = 1e3 * t.solve;
  out.surface_ms = 1e3 * t.surface;
  out.other_ms = 1e3 * (t.total - t.advection - t.contact - t.geometry - t.solve - t.surface);
  out.good = true;
  return out;
}

}  // namespace monolith::bench
