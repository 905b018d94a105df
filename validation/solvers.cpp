#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "cases.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

constexpr int kSteps = 3;
constexpr int kBodies = 4;      // most of one scene
constexpr double kGoal = 1e-4;  // of the motion at tolerance 1e-7, between any two where the answer is unique

// What a run leaves behind, sent through a pipe from the process that ran it.
struct Result {
  bool good = false;
  int bodies = 0;
  double twist[6 * kBodies] = {};
  double energy = 0.0;
  long iterations = 0;
  long solves = 0;
  double seconds = 0.0;
  char message[256] = {};
};

Scene base(const char* name, double viscosity, double fill) {
  Scene scene;
  scene.name = name;
  scene.tank.size = {0.16, 0.16, 0.16};
  scene.tank.cell_width = 0.16 / 12.0;
  scene.liquid.density = 1000.0;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = fill;
  scene.time_step = 0.01;
  scene.contact.friction = 0.3;
  scene.solver.threads = 1;
  scene.solver.maximum_iterations = 400;
  return scene;
}

std::vector<Scene> scenes() {
  std::vector<Scene> out;
  // A light and a heavy sphere in thick liquid.
  Scene spheres = base("spheres", 5.0, 0.16);
  spheres.bodies = {sphereBody("light", 0.03, 10.0, {0.05, 0.06, 0.05}),
                    sphereBody("heavy", 0.03, 5000.0, {0.11, 0.1, 0.1})};
  out.push_back(spheres);
  // The same in liquid that is hardly viscous, with a surface.
  Scene thin = base("thin", 1e-3, 0.11);
  thin.bodies = spheres.bodies;
  out.push_back(thin);
  // Three boxes on the floor, pushed by a tilted gravity: many contacts, some slip.
  Scene stack = base("stack", 1.0, 0.13);
  stack.gravity = {3.0, 0.5, -9.2};
  stack.bodies = {boxBody("low", {0.08, 0.07, 0.03}, 1500.0, {0.07, 0.08, 0.015}),
                  boxBody("middle", {0.06, 0.06, 0.03}, 3000.0, {0.07, 0.08, 0.045}),
                  boxBody("high", {0.04, 0.05, 0.03}, 8000.0, {0.07, 0.08, 0.075})};
  out.push_back(stack);
  // Without friction the couplings must agree (the paper's supplement, section 4).
  Scene slippery = stack;
  slippery.name = "slippery";
  slippery.contact.friction = 0.0;
  out.push_back(slippery);
  // And dry.
  Scene dry = stack;
  dry.name = "dry stack";
  dry.liquid.fill_level = 0.0;
  out.push_back(dry);
  return out;
}

Result run(const Scene& scene) {
  Result out;
  try {
    Simulation simulation(scene);
    const auto start = std::chrono::steady_clock::now();
    out.good = true;
    for (int i = 0; i < kSteps && out.good; ++i) {
      const StepReport r = simulation.step();
      out.good = r.committed();
      out.iterations += r.iterations;
      out.solves += r.liquid_solves;
      out.energy = r.kinetic_energy;
      std::strncpy(out.message, r.message.c_str(), sizeof(out.message) - 1);
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / kSteps;
    for (const RigidBody& body : simulation.bodies()) {
      Eigen::Map<Vector6d>(out.twist + 6 * out.bodies++) = body.twist;
    }
  } catch (const std::exception& error) {
    std::strncpy(out.message, error.what(), sizeof(out.message) - 1);
  }
  return out;
}

// In a process of its own, whose memory can be told from that of the others. MB.
Result runApart(const Scene& scene, double& memory) {
  int ends[2];
  Result result;
  if (pipe(ends) != 0) return result;
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    result = run(scene);
    const ssize_t written = write(ends[1], &result, sizeof(result));
    _exit(written == sizeof(result) ? 0 : 1);
  }
  close(ends[1]);
  if (read(ends[0], &result, sizeof(result)) != sizeof(result)) {
    std::snprintf(result.message, sizeof(result.message), "the run broke off");
  }
  close(ends[0]);
  rusage usage{};
  int status = 0;
  wait4(child, &status, 0, &usage);
  memory = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return result;
}

double difference(const Result& a, const Result& b) {
  const Eigen::Map<const Eigen::VectorXd> x(a.twist, 6 * a.bodies), y(b.twist, 6 * b.bodies);
  return (x - y).norm() / y.norm();
}

}  // namespace

bool runSolvers() {
  bool met = true;
  std::printf(
      "%d steps of 10 ms, 12^3 cells, one thread. Error: of the bodies' twists, against `direct` at 1e-10 of the same\n"
      "discretisation. MB: of the whole process.\n",
      kSteps);
  std::printf("%-10s %-10s %-10s %-10s %10s %10s %10s %8s %10s %7s\n", "scene", "cells", "solver", "coupling",
              "tolerance", "error", "iterations", "solves", "ms/step", "MB");
  for (const Discretisation cells : {Discretisation::kFitted, Discretisation::kFractions}) {
    for (Scene scene : scenes()) {
      scene.solver.discretisation = cells;
      if (cells == Discretisation::kFractions && !(scene.liquid.fill_level > 0.0)) continue;  // without liquid the same
      Scene exact = scene;
      exact.solver.name = SolverName::kDirect;
      exact.solver.tolerance = 1e-10;
      double memory = 0.0;
      const Result truth = runApart(exact, memory);
      if (!truth.good) {
        std::printf("%s: %s\n", scene.name.c_str(), truth.message);
        met = false;
        continue;
      }
      for (const auto& [name, text] : {std::pair(SolverName::kFast, "fast"), std::pair(SolverName::kDirect, "direct"),
                                       std::pair(SolverName::kReference, "reference")}) {
        for (const auto coupling : {CouplingName::kUnified, CouplingName::kIterative}) {
          for (const double tolerance : {1e-5, 1e-7}) {
            Scene variant = scene;
            variant.solver.name = name;
            variant.solver.coupling = coupling;
            variant.solver.tolerance = tolerance;
            const Result r = runApart(variant, memory);
            std::printf("%-10s %-10s %-10s %-10s %10.0e ", scene.name.c_str(),
                        cells == Discretisation::kFitted ? "fitted" : "fractions", text,
                        coupling == CouplingName::kUnified ? "unified" : "iterative", tolerance);
            if (!r.good) {
              std::printf("%s\n", r.message);
              met = met && coupling == CouplingName::kIterative;
              continue;
            }
            const double error = difference(r, truth);
            // Friction of redundant contacts has more than one answer, and the slower ways may end at another.
            const bool unique = scene.contact.friction == 0.0 || scene.bodies.size() < 3 ||
                                (coupling == CouplingName::kUnified && name != SolverName::kReference);
            met = met && (tolerance > 1e-6 || !unique || error < kGoal);
            std::printf("%10.1e %10ld %8ld %10.1f %7.0f\n", error, r.iterations, r.solves, 1e3 * r.seconds, memory);
            std::fflush(stdout);
          }
        }
      }
    }
  }
  std::printf("solvers: at 1e-7 all agree within %.0e  %s\n", kGoal, met ? "met" : "MISSED");
  return met;
}

}  // namespace monolith
