#include "node/health_diagnostics.h"

#include <ros/time.h>

#include <cmath>

namespace monolith {
namespace {

constexpr double kRealTime = 0.95;         // a paced run below this factor is too slow
constexpr double kVolumeTolerance = 0.01;  // of the initial volume

double wallNow() { return ros::SteadyTime::now().toSec(); }

}  // namespace

HealthDiagnostics::HealthDiagnostics(const std::string& scene_name) {
  updater_.setHardwareID("scene " + scene_name);
  updater_.add("Real-time factor", this, &HealthDiagnostics::tellSpeed);
  updater_.add("Solver", this, &HealthDiagnostics::tellSolver);
  updater_.add("Liquid", this, &HealthDiagnostics::tellLiquid);
  updater_.add("Commands", this, &HealthDiagnostics::tellCommands);
}

void HealthDiagnostics::countRefusal(const std::string& message) {
  ++refusals_;
  last_refusal_ = message;
  last_refusal_wall_sec_ = wallNow();
}

void HealthDiagnostics::update(const NodeHealth& health, bool force) {
  const double now = wallNow();
  if (!force && now - last_update_wall_sec_ < updater_.getPeriod()) return;
  last_update_wall_sec_ = now;
  health_ = health;
  updater_.force_update();
}

void HealthDiagnostics::tellSpeed(Status& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (health_.paused) {
    status.summary(DiagnosticStatus::OK, "Paused");
  } else if (health_.real_time_factor <= 0.0) {
    status.summary(DiagnosticStatus::OK, "Not known yet");
  } else if (health_.paced && health_.real_time_factor < kRealTime) {
    status.summaryf(DiagnosticStatus::WARN, "Slower than real time: %.2f", health_.real_time_factor);
  } else {
    status.summaryf(DiagnosticStatus::OK, "%.2f of real time", health_.real_time_factor);
  }
  status.add("Real-time factor", health_.real_time_factor);
  status.add("Paced", health_.paced);
  status.add("Simulated time (s)", health_.report.time);
  status.add("Wall time of the last step (s)", health_.report.times.total);
}

void HealthDiagnostics::tellSolver(Status& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const StepReport& report = health_.report;
  if (health_.failed) {
    status.summary(DiagnosticStatus::ERROR,
                   std::string("Step not committed: ") + toString(report.status) + ": " + report.message);
  } else if (report.status == SolveStatus::kNotRun) {
    status.summary(DiagnosticStatus::OK, "No step yet");
  } else {
    status.summary(DiagnosticStatus::OK, "Converged");
  }
  status.add("Status", toString(report.status));
  status.add("Step", report.step);
  status.add("Sub-steps", report.substeps);
  status.add("Retries", report.retries);
  status.add("Iterations", report.iterations);
  status.add("Residual", report.residual);
  status.add("Divergence (1/s)", report.divergence);
  status.add("Contacts", report.model.contacts);
  status.add("Penetration (m)", report.penetration);
}

void HealthDiagnostics::tellLiquid(Status& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const StepReport& report = health_.report;
  const double drift = health_.initial_volume > 0.0 ? report.liquid_volume / health_.initial_volume - 1.0 : 0.0;
  if (report.status == SolveStatus::kNotRun) {
    status.summary(DiagnosticStatus::OK, "No step yet");
  } else if (std::abs(drift) > kVolumeTolerance) {
    status.summaryf(DiagnosticStatus::WARN, "Volume changed by %.1f %% since the start", 100.0 * drift);
  } else if (!report.model.liquid) {
    status.summary(DiagnosticStatus::OK, "No liquid");
  } else {
    status.summary(DiagnosticStatus::OK, "Volume kept");
  }
  status.add("Volume (m^3)", report.liquid_volume);
  status.add("Change since the start", drift);
  status.add("Correction in the last step (m^3)", report.volume_correction);
  status.add("Free surface", report.model.free_surface);
  status.add("Largest speed (m/s)", report.maximum_speed);
}

void HealthDiagnostics::tellCommands(Status& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (refusals_ > 0 && wallNow() - last_refusal_wall_sec_ < kRefusalSec) {
    status.summary(DiagnosticStatus::WARN, "Refused: " + last_refusal_);
  } else {
    status.summary(DiagnosticStatus::OK, "None refused lately");
  }
  status.add("Refused since the start", refusals_);
  status.add("Last refused", last_refusal_);
}

}  // namespace monolith
