#pragma once
// A validation case: physics whose answer is known, computed by the production library on scenes that a user could
// write, with what a user could choose (Numerics) varied. Each of its runs gives errors and the time that they took.
//
// A new case is one file in validation/physics that defines `Case name();` and one line in physics/case_list.inc.

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace monolith {

class Meter;

enum class Extent { kQuick, kFull };  // what the tests run; what people run

// What one run is computed with. The command line may replace any of it.
struct Numerics {
  double cells_across = 8.0;  // cells along the length that Case::across names
  double dt = 0.0;            // s, output step; 0: as the case has it
  double tolerance = 1e-5;
  SolverName solver = SolverName::kFast;
  Discretisation discretisation = Discretisation::kFitted;
};

struct Measurement {
  std::string quantity;  // with its unit: "peak speed, m/s"
  double result = 0.0;
  double reference = 0.0;
  double goal = 0.0;       // largest |error()| that is wanted; 0: none
  double scale = 0.0;      // of the error; 0: the reference
  bool yes_or_no = false;  // of observed(): its error says nothing about accuracy
  double error() const { return (result - reference) / (scale != 0.0 ? scale : reference); }
};

// What is right only in kind: 1 if it was seen, and only that will do.
Measurement observed(const std::string& phenomenon, bool seen);

// Simulates and measures. Throws RunFailed (framework/meter.h) where a step fails.
using RunFunction = std::function<std::vector<Measurement>(const Numerics&, Meter&)>;

struct Variant {
  std::string name;  // what is simulated; not what with
  Numerics numerics;
  bool judged = true;  // goals count: not where a sweep makes the numerics worse on purpose
  RunFunction run;
};

// An order of convergence that the quick subset must show: error ~ (1/cells_across)^order, or ~ dt^order.
struct ExpectedOrder {
  std::string variant;
  std::string quantity;
  bool in_time = false;
  double least = 1.0;
};

struct Case {
  std::string name;       // as on the command line
  std::string title;      // one line
  std::string reference;  // where the right answer comes from
  std::string across;     // "diameter": what cells_across counts
  bool steady = false;    // the answer is a steady state: the time that its steps cover means nothing
  std::function<std::vector<Variant>(Extent)> variants;
  std::vector<ExpectedOrder> orders;
};

// `run` with another goal for a quantity. For the quick subset where a run misses its own: no worse than it is, so that
// the tests see a loss of accuracy there, too.
RunFunction atMost(double bound, const std::string& quantity, const RunFunction& run);

// Base numerics, and the values that replace one of them at a time. The runs with other steps or tolerances are not
// judged.
struct Sweep {
  Numerics base;
  std::vector<double> cells;  // all of them, the base's included; empty: the base's
  std::vector<double> steps;
  std::vector<double> tolerances;
  bool fractions = false;  // the base also with the paper's volume fractions, not judged
};
void addSweep(const std::string& variant, const Sweep& sweep, const RunFunction& run, std::vector<Variant>& out);

std::vector<Case> allCases();

}  // namespace monolith
