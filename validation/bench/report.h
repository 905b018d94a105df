#pragma once
// One line of the table, and of JSON, for each combination.

#include <cstdio>
#include <string>

#include "framework/run_record.h"
#include "measure.h"

namespace monolith::bench {

struct Row {
  Case wanted;
  Accuracy accuracy;
  StepFigures steps;
  double bandwidth = 0.0;        // bytes/s that the solve's kernels stream, from caches or memory
  double bandwidth_share = 0.0;  // of what the machine's memory gives, measured in the same run
  double speedup = 0.0;          // over the other solver, at equal true error; 0: none asked for
  std::string against;
  double against_ms = 0.0;
  double against_error = 0.0;
  double against_tolerance = 0.0;
  // Over a step with the same bodies a cell apart; 0: no contacts, or they touch there too.
  double contact_factor = 0.0;
  double thread_speedup = 1.0;    // over the first number of threads
  double iteration_growth = 1.0;  // over the first size
};

void printHead(std::FILE* to);
void printRow(const Row& row, std::FILE* to);
std::string toJson(const Row& row, const Origin& origin);

}  // namespace monolith::bench
