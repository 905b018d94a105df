#pragma once
// Time stepping, of liquid and bodies alike. With the mean acceleration A^n that a particle of liquid or a body had
// over the last step, and f what acts on it at the end of this one (pressure, viscosity, gravity):
//
//   u^(n+1) = u^n(x_d) + dt ((1 - b) A^n(x_d) + b f^(n+1)),      A^(n+1) = (u^(n+1) - u^n(x_d))/dt
//
// b = 1: backward Euler. b = (1 + r)/(1 + 2 r), r = dt/dt_last: the second-order backward differentiation formula with
// variable steps (BDF2; Hairer & Norsett & Wanner, Solving ODEs I, III.5), x_d the foot of the particle's trajectory.
// The solve is the same with b dt in place of dt: L-stable, so that stiff viscosity is damped at once.
//
// Bodies: momentum and angular momentum, gravity and wrenches from outside held over the step; (1 - b) of the liquid's
// mean wrench on the body is carried over, which therefore is reported as the mean over the step: with it and with that
// of the contacts m (v^(n+1) - v^n)/dt = sum of wrenches + m g holds exactly. So is (1 - b) of what joints do, which
// the solve has in the directions that they leave at the end of the step; what is reported of joints is their mean,
// too.
//
// Where bodies and surface are in the solve: with BDF2 at x^n + dt u^n, corrected to x^n + dt (u^n + u^(n+1))/2 after
// it. For a wave or a floating body this pair is neutrally stable up to omega dt = 2, as is backward Euler's x^n in the
// solve and x^n + dt u^(n+1) after it. Neutral is not enough for waves: whatever feeds one, as steep ones are by their
// resolution, feeds it for ever, and splashed water came to have more energy than it had fallen with. So the surface is
// a little ahead in the solve, with the mean acceleration a^n of the step before, of which it would be a half exactly:
//
//   x^n + dt (u^n + c dt a^n):   a wave loses 3/4 c (omega dt)^4 of its height each step,
//
// by c = 0.1 where liquid is as fast as a third of sqrt(g h) somewhere, by less where it is slower: low waves keep what
// they have.
//
// The shortest waves that a grid holds, of two cells, would go beyond that in steps of sqrt(h/g) and more, and a
// surface would never come to rest: see longestWaveStep().
//
// Steps in which liquid crosses most of a cell or more are of backward Euler, whatever was asked for.
//
// After a jump of the velocity (a start, a state that was set, an impact) a step has no past to continue: it is one of
// backward Euler.

namespace monolith {

struct StepWeights {
  int order = 1;
  double dt = 0.0;        // s, the step
  double implicit = 0.0;  // s, b dt: what the solve takes for the step
  double carry = 0.0;     // 1 - b
};

StepWeights eulerWeights(double dt);
// Backward Euler if the step is more than twice the last one (zero-stable up to 1 + sqrt(2)) or there is none.
StepWeights bdf2Weights(double dt, double last_dt);

// c, and its largest value. liquid_speed: no point of the liquid is faster.
constexpr double kSurfaceAhead = 0.1;
double surfaceAhead(double liquid_speed, double gravity, double cell_width);

// s, up to which the shortest waves on deep liquid do not grow. With k = pi/h, omega^2 = g k and the damping nu k^2,
// which is implicit, they are stable while (omega dt)^2 < (4 + 4 nu k^2 dt)/(1 + 2 c).
double stableWaveStep(double cell_width, double gravity, double kinematic_viscosity);
// Up to which they die away: (omega dt)^2 < 2 + 2 nu k^2 dt.
double longestWaveStep(double cell_width, double gravity, double kinematic_viscosity);

}  // namespace monolith
