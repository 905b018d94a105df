#pragma once
// Efforts (N m, N) in the joints of a step, other than those that hold them together: what is commanded, a servo,
// damping d and Coulomb friction F. With the joint's position q and velocity q', and what a servo is to follow,
//
//   drive  = e + k (q_c - q) + c (q'_c - q'),   |drive| <= most_effort       e: commanded
//   losses = -d q' - f,   |f| <= F, opposite to q' where the joint slides; where it sticks q' = 0
//
// Servo and damping are implicit, taken at the end of the step, so that no stiffness is too large for it; e is held
// over it. What a limited effort does - servo at its limit, friction sliding or sticking - is found by trying what it
// did last and looking at the motion that comes of it, until they agree.

#include <vector>

#include "rigid/rigid_body.h"
#include "simulation/time_stepping.h"

namespace monolith {

// What a joint is told to do, until told otherwise.
struct JointCommand {
  double effort = 0.0;    // N m, N
  double position = 0.0;  // rad, m
  double velocity = 0.0;  // rad/s, m/s
};

// -1, 1: at its limit, of this sign; of friction the sign of the sliding velocity. 0: not limited, sticking.
struct JointMode {
  int servo = 0;
  int friction = 0;
};

class JointDrives {
 public:
  // bodies: at the start of the step. modes: of the last one.
  JointDrives(const std::vector<RigidBody>& bodies, const std::vector<JointCommand>& commands, const StepWeights& w,
              std::vector<JointMode> modes);

  // Commanded effort of body b's joint that is held over the step.
  static double heldEffort(const RigidBody& body, const JointCommand& command);

  // Whether servos or friction act in a joint, and whether a mode may turn out to be another; after how many rounds of
  // that it will not settle.
  bool any() const;
  bool limited() const;
  int mostRounds() const;
  // rad/s, m/s, that the joint of body b is at most to be expected at in this step, as far as its servo tells.
  double fastest(std::size_t b) const;
  // What servo, damping and friction do to body b's joint in these modes, as the solve takes it: its impulse is
  // effort dt - resistance q'.
  double effort(std::size_t b) const;
  std::vector<double> resistances() const;

  // Modes by the joints' velocities that came of them; returns whether they were right.
  bool agree(const std::vector<double>& velocities);
  const std::vector<JointMode>& modes() const { return modes_; }

  // Mean over the step that joint b's motion brings: of the servo, which is part implicit; and of friction.
  double servoEffort(std::size_t b, double velocity) const;
  double frictionEffort(std::size_t b, double velocity) const;

 private:
  struct Servo {
    double constant = 0.0, slope = 0.0;  // constant - slope q'
    double most = 0.0, least = 0.0;      // of that
  };
  double resistance(std::size_t b) const;
  Servo servoOf(std::size_t b) const;
  double stickResistance(std::size_t b) const;

  const std::vector<RigidBody>& bodies_;
  const std::vector<JointCommand>& commands_;
  StepWeights weights_;
  std::vector<JointMode> modes_;
  std::vector<double> inertia_;  // of all that hangs on each joint, about its axis
};

}  // namespace monolith
