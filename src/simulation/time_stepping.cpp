#include "simulation/time_stepping.h"

#include <cmath>

namespace monolith {
namespace {

constexpr double kLargestRatio = 2.0 + 1e-6;
constexpr double kFastSurface = 0.1;  // of gravity times the cell width: the square of a speed

}  // namespace

StepWeights eulerWeights(double dt) { return {1, dt, dt, 0.0}; }

StepWeights bdf2Weights(double dt, double last_dt) {
  if (!(last_dt > 0.0) || dt > kLargestRatio * last_dt) return eulerWeights(dt);
  const double r = dt / last_dt;
  return {2, dt, (1.0 + r) / (1.0 + 2.0 * r) * dt, r / (1.0 + 2.0 * r)};
}

double surfaceAhead(double liquid_speed, double gravity, double cell_width) {
  const double fast = kFastSurface * gravity * cell_width, square = liquid_speed * liquid_speed;
  return square < fast ? kSurfaceAhead * square / fast : kSurfaceAhead;
}

namespace {

// dt with (omega dt)^2 = bound (1 + nu k^2 dt).
double waveStep(double bound, double cell_width, double gravity, double kinematic_viscosity) {
  const double k = M_PI / cell_width;
  const double damping = bound * kinematic_viscosity * k * k, square = gravity * k;
  return 0.5 * (damping + std::sqrt(damping * damping + 4.0 * bound * square)) / square;
}

}  // namespace

double stableWaveStep(double cell_width, double gravity, double kinematic_viscosity) {
  return waveStep(4.0 / (1.0 + 2.0 * kSurfaceAhead), cell_width, gravity, kinematic_viscosity);
}

double longestWaveStep(double cell_width, double gravity, double kinematic_viscosity) {
  return waveStep(2.0, cell_width, gravity, kinematic_viscosity);
}

}  // namespace monolith
