#pragma once
// What a run costs: goes between a case and its simulations.

#include <functional>
#include <stdexcept>

#include "simulation/simulation.h"

namespace monolith {

// A step that was not committed; what() is what it reports.
class RunFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// CPU time of this process, all threads, s.
double cpuSeconds();

class Meter {
 public:
  // progress: called with the part that is done, 0 to 1; may be empty.
  explicit Meter(std::function<void(double)> progress = {});

  // One output step; throws RunFailed.
  StepReport step(Simulation& simulation);
  // Steps until simulation.time() reaches `time` (s), calling `after` (may be empty) after each.
  void advance(Simulation& simulation, double time, const std::function<void(const StepReport&)>& after = {});
  void progress(double part) const;
  // Costs count from here: those so far were of a reference.
  void restart();
  // The number of cells that a whole number of them in the tank led to, where it is not what the numerics ask for.
  void setCellsAcross(double cells) { cells_across_ = cells; }

  double cpu() const;                                   // s, since construction or restart
  double wall() const;                                  // s, likewise
  double simulated() const { return simulated_; }       // s
  double dt() const { return dt_; }                     // s, of the last step
  double cellsAcross() const { return cells_across_; }  // 0: as asked for
  long steps() const { return steps_; }
  long substeps() const { return substeps_; }
  long iterations() const { return iterations_; }

 private:
  std::function<void(double)> progress_;
  double cpu_start_ = 0.0;
  double wall_start_ = 0.0;
  double simulated_ = 0.0;
  double dt_ = 0.0;
  double cells_across_ = 0.0;
  long steps_ = 0;
  long substeps_ = 0;
  long iterations_ = 0;
};

}  // namespace monolith
