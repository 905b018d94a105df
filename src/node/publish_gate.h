#pragma once
// Which steps of length `step_sec` a topic of `rate_hz` is published after: those in which a multiple of the period
// passes, so the mean rate is exact also when the period is no whole number of steps, and at most every step.

#include <algorithm>
#include <cmath>

namespace monolith {

class PublishGate {
 public:
  PublishGate(double rate_hz, double step_sec) : periods_per_step_(std::min(rate_hz * step_sec, 1.0)) {}

  // Step 0 is the initial state, which is always published.
  bool isDue(long step) const { return step <= 0 || periods(step) > periods(step - 1); }

 private:
  double periods(long step) const { return std::floor(static_cast<double>(step) * periods_per_step_ + 1e-6); }

  double periods_per_step_;
};

}  // namespace monolith
