#pragma once
// The co-simulation: liquid and rigid bodies advanced together, one coupled solve a sub-step. No ROS in here.
//
//   Simulation simulation(loadScene("drop.yaml"));
//   StepReport report = simulation.step();
//
// A step whose solve fails is not committed: the state stays as it was before, and the report says why. So is one in
// which anything throws.

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <vector>

#include "rigid/integration.h"
#include "rigid/rigid_body.h"
#include "scene/scene.h"
#include "simulation/joint_drives.h"
#include "simulation/statistics.h"

namespace monolith {

// State of a body as its users see it: the body frame B (the URDF's root link), not the centre of mass.
struct BodyState {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s, of the origin of B, in W
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, in W
  Wrench liquid;   // on the body, at the centre of mass, mean over the last step
  Wrench contact;  // likewise
};

// Joint by which a body hangs on another: rad, rad/s, N m, or m, m/s, N.
struct JointState {
  int body = 0;
  double position = 0.0;
  double velocity = 0.0;
  double effort = 0.0;  // of command and servo, or of what prescribes its motion, mean over the last step
};

struct SurfacePoint {
  Eigen::Vector3f position;  // m, in W
  Eigen::Vector3f normal;    // unit, out of the liquid
  Eigen::Vector3f velocity;  // m/s
};

class Simulation {
 public:
  // Throws SceneError: a body outside the tank, bodies that overlap, a time step too long for the liquid's surface.
  explicit Simulation(const Scene& scene);
  ~Simulation();

  const Scene& scene() const;
  double time() const;
  // What of the scene its grid or its time step is too coarse for, to be shown to whoever runs it.
  const std::vector<std::string>& warnings() const;

  // Advances by scene().time_step, in as many sub-steps as the CFL number, the surface's waves and prescribed
  // oscillations ask for, but 64 at most, whatever they ask for.
  [[nodiscard]] StepReport step();
  // Report of the last step, committed or not; before the first its status is kNotRun. Volume and energies are those of
  // the present state also after setBodyState().
  const StepReport& report() const;

  // Indexed as scene().bodies.
  std::vector<BodyState> bodyStates() const;
  const std::vector<RigidBody>& bodies() const;
  // Acts on body i during the steps to come, until replaced. Throws std::invalid_argument unless finite.
  void setWrench(int body, const Wrench& wrench);
  // In the order of the bodies.
  std::vector<JointState> jointStates() const;
  // What the joint of a body is to do during the steps to come, until replaced; at first nothing, its servo to stay
  // where it starts. Throws std::invalid_argument unless finite, and of a body without a joint that may move freely.
  void setJointCommand(int body, const JointCommand& command);
  // Throws std::invalid_argument unless finite, inside the tank and clear of the other bodies. Along periodic axes any
  // image of the pose will do; the one in the tank is kept. What hangs on the body goes with it, its joints as they
  // are; a body that hangs on another cannot be set.
  void setBodyState(int body, const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& velocity,
                    const Eigen::Vector3d& angular_velocity);

  // Sets joints of bodies that hang on one root, all at once; efforts are not looked at, servos and commands stay as
  // they are. Throws std::invalid_argument, with nothing changed, of a body without a joint or with one that is
  // prescribed, unless finite and within the joint's range, and unless all that they move is inside the tank and clear
  // of the other bodies.
  void setJointStates(const std::vector<JointState>& states);

  // Gives the liquid, wherever it is, this velocity (m/s) of a point in W; of what diverges the next step takes the
  // divergence. What sticks to a body moves like the points around it. Throws std::invalid_argument unless finite.
  void setLiquidVelocity(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity);

  // Points of the free surface, about one for each cell that it crosses; empty without a free surface.
  std::vector<SurfacePoint> surfacePoints() const;

  // Velocity of the liquid, m/s, at a point in W; beyond the liquid what it is continued by. Throws
  // std::invalid_argument unless finite.
  Eigen::Vector3d liquidVelocity(const Eigen::Vector3d& point) const;

  // Back to the scene's initial state, time 0, no wrenches, no commands to joints.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace monolith
