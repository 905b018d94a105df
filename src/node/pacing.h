#pragma once
// Wall clock and simulated time. Both classes are told the wall time (s, any origin), so that they hold no clock.

#include <deque>
#include <utility>

namespace monolith {

// Says when the next step is due so that simulated time keeps to wall time. Each due time follows from one common
// origin, not from the step before: no drift. A simulation that was slow for a while catches up by at most
// kLongestCatchUpSec, not with a burst.
class RealTimePacer {
 public:
  static constexpr double kLongestCatchUpSec = 0.25;

  // From here on, simulated time `simulated_sec` is wall time `wall_sec`.
  void restart(double wall_sec, double simulated_sec);
  // How long until the wall time at which `simulated_sec` is due; <= 0: now.
  double remaining(double wall_sec, double simulated_sec);

 private:
  double offset_sec_ = 0.0;  // wall time minus simulated time
};

// Simulated time over wall time during the last kWindowSec of wall time.
class RealTimeFactor {
 public:
  static constexpr double kWindowSec = 1.0;

  void restart() { samples_.clear(); }
  void add(double wall_sec, double simulated_sec);
  // 0 until there are two samples.
  double value() const;

 private:
  std::deque<std::pair<double, double>> samples_;  // wall, simulated
};

}  // namespace monolith
