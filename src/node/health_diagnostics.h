#pragma once
// Health of the node on /diagnostics: does it keep to real time, does the solver converge, is the liquid's volume kept,
// were commands refused. At least once per ~diagnostic_period of wall time, also while simulated time stands still.

#include <diagnostic_updater/diagnostic_updater.h>

#include <string>

#include "simulation/statistics.h"

namespace monolith {

struct NodeHealth {
  bool paused = false;
  bool paced = true;
  double real_time_factor = 0.0;
  bool failed = false;          // the last step was not committed
  StepReport report;            // of the last step
  double initial_volume = 0.0;  // m^3 of liquid, of the scene at time 0
};

class HealthDiagnostics {
 public:
  static constexpr double kRefusalSec = 10.0;  // of wall time that a refused command is a warning

  explicit HealthDiagnostics(const std::string& scene_name);

  void countRefusal(const std::string& message);
  // Publishes when due, or at once with `force`.
  void update(const NodeHealth& health, bool force);

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  void tellSpeed(Status& status);
  void tellSolver(Status& status);
  void tellLiquid(Status& status);
  void tellCommands(Status& status);

  diagnostic_updater::Updater updater_;
  NodeHealth health_;
  long refusals_ = 0;
  std::string last_refusal_;
  double last_refusal_wall_sec_ = 0.0;
  double last_update_wall_sec_ = -1e9;
};

}  // namespace monolith
