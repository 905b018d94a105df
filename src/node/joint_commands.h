#pragma once
// What users command of joints: positions until others are commanded, velocities and efforts until their time is over.
// Each by itself: a new position leaves the effort as it is.

#include <vector>

#include "scene/scene.h"
#include "simulation/joint_drives.h"

namespace monolith {

class JointCommands {
 public:
  // Positions are at first those that the joints start at, as the simulation's are.
  explicit JointCommands(const Scene& scene);

  // Of the joint by which a body hangs on another. end: s, simulated; acts in at least one step.
  void holdPosition(int body, double position) { held_[body].position = position; }
  void holdVelocity(int body, double velocity, double end) { held_[body].velocity = {velocity, end}; }
  void holdEffort(int body, double effort, double end) { held_[body].effort = {effort, end}; }
  // As at first.
  void clear();

  // For each body of the scene, in the step that begins at `time`. What is over is forgotten.
  std::vector<JointCommand> evaluate(double time);
  // The step that was evaluated last was committed: only now have its commands acted.
  void commit();

 private:
  struct Timed {
    double value = 0.0;
    double end = 0.0;  // s
    bool has_acted = false;
  };
  struct Held {
    double position = 0.0;
    Timed velocity, effort;
  };
  double evaluate(Timed& timed, double time) const;

  std::vector<double> initial_positions_;
  double slack_;  // s
  std::vector<Held> held_;
};

}  // namespace monolith
