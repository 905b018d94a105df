#pragma once
// Rate, 1/s, of sin(2 pi frequency t + phase), by which motions are prescribed.

#include <cmath>

namespace monolith {

inline double oscillation(double frequency, double phase, double time) {
  const double rate = 2.0 * M_PI * frequency;
  return rate * std::cos(rate * time + phase);
}

// Its mean from `time` on over dt.
inline double meanOscillation(double frequency, double phase, double time, double dt) {
  const double half = M_PI * frequency * dt;  // of the angle that it passes
  // (sin(a + 2 half) - sin(a))/dt without the difference.
  return 2.0 / dt * std::sin(half) * std::cos(2.0 * M_PI * frequency * time + half + phase);
}

}  // namespace monolith
