#include "node/pacing.h"

#include <algorithm>

namespace monolith {

void RealTimePacer::restart(double wall_sec, double simulated_sec) { offset_sec_ = wall_sec - simulated_sec; }

double RealTimePacer::remaining(double wall_sec, double simulated_sec) {
  const double late = wall_sec - simulated_sec - offset_sec_;
  offset_sec_ += std::max(late - kLongestCatchUpSec, 0.0);
  return -late;
}

void RealTimeFactor::add(double wall_sec, double simulated_sec) {
  samples_.emplace_back(wall_sec, simulated_sec);
  // The oldest one kept is the last that spans the whole window.
  while (samples_.size() > 2 && wall_sec - samples_[1].first >= kWindowSec) samples_.pop_front();
}

double RealTimeFactor::value() const {
  if (samples_.size() < 2) return 0.0;
  const double wall = samples_.back().first - samples_.front().first;
  return wall > 0.0 ? (samples_.back().second - samples_.front().second) / wall : 0.0;
}

}  // namespace monolith
