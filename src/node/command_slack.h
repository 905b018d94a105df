#pragma once
// Commands mean whole steps, but their times are rounded.

#include <algorithm>

namespace monolith {

// s: by so much a command's times may miss the beginning of a step, of length time_step, that they mean.
inline double commandSlack(double time_step) {
  constexpr double kRoundOff = 1e-6;  // of a step, of its beginning
  constexpr double kStampRoundOff =
      2e-9;                            // s: ROS holds two times, whose difference a request is, in whole nanoseconds
  constexpr double kMostSlack = 0.25;  // of a step, where it is hardly longer than that
  return std::min(std::max(kRoundOff * time_step, kStampRoundOff), kMostSlack * time_step);
}

}  // namespace monolith
