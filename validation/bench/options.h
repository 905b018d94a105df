#pragma once
// What the benchmark is to measure: every combination of the lists, in one run.

#include <string>
#include <vector>

#include "scene/scene.h"

namespace monolith::bench {

struct Options {
  std::vector<int> sizes = {16, 32, 48, 64};  // cells along each edge of the tank
  std::vector<int> threads = {1, 2};          // by default cut to what the machine has
  std::vector<double> viscous_numbers = {1.0, 100.0};
  std::vector<int> bodies = {1};    // free spheres in the liquid
  std::vector<int> contacts = {0};  // contact points of further bodies that rest on floor and each other
  std::vector<SolverName> solvers = {SolverName::kFast};
  double fill = 1.0;       // part of the tank's height that is liquid; 1: full, closed
  double tolerance = 0.0;  // of the solves; 0: the loosest that reaches `error`
  double error = 1e-4;     // of the bodies' accelerations, relative
  int repetitions = 5;     // steps that are timed
  bool compare = false;
  SolverName against = SolverName::kReference;
  std::string json;  // file; "-": standard output; empty: none
  bool help = false;
};

const char* usage();

// Throws std::invalid_argument: option, value and what was expected.
Options parse(int argc, char** argv);

}  // namespace monolith::bench
