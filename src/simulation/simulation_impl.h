#pragma once
// What the sources of Simulation share: its parts.

#include <chrono>
#include <functional>
#include <memory>

#include "coupling/coupled_system.h"
#include "coupling/sticking_liquid.h"
#include "fluid/free_surface.h"
#include "rigid/contact.h"
#include "simulation/body_motion.h"
#include "simulation/contact_laws.h"
#include "simulation/joint_drives.h"
#include "simulation/liquid_state.h"
#include "simulation/non_newtonian.h"
#include "simulation/saved_state.h"
#include "simulation/simulation.h"
#include "simulation/simulation_state.h"
#include "simulation/time_stepping.h"

namespace monolith {

constexpr double kMostIntrusion = 0.5;  // of a cell, that bodies may come into walls or each other

// Adds the time until it goes out of scope.
class StageClock {
 public:
  explicit StageClock(double& total) : total_(total), start_(std::chrono::steady_clock::now()) {}
  ~StageClock() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_;
};

struct Simulation::Impl {
  explicit Impl(const Scene& s)
      : scene(s),
        grid(makeGrid(s.tank, s.liquid)),
        walls(makeWalls(s.tank)),
        sampler(grid),
        system(grid, s.solver.name, s.solver.coupling, s.solver.discretisation),
        laws(s),
        viscosity_law(makeViscosityLaw(s.liquid)) {}

  static TankWalls makeWalls(const TankDescription& tank) {
    TankWalls walls;
    walls.inside = Eigen::AlignedBox3d(tank.origin, tank.origin + tank.size);
    for (int a = 0; a < 3; ++a) walls.periodic[a] = tank.periodic[a];
    return walls;
  }

  void initialise();
  bool hasLiquid() const { return !state.surface[0].empty(); }
  bool hasSurface() const { return hasLiquid() && !state.surface[0].full(); }
  bool nonNewtonian() const { return hasLiquid() && !viscosity_law.constant(); }
  bool noSlip() const { return viscosity_law.most() > 0.0; }
  double bodySpeed() const;
  double typicalSpeed() const;
  double longestStep() const;
  bool substep(double dt, StepReport& report);
  bool secondOrder() const { return scene.solver.time_stepping == TimeStepping::kBdf2; }
  StepWeights weights(double dt) const;
  double contactReach(double dt) const;
  std::vector<Wrench> actingWrenches() const;
  double servoSpeed(double dt) const;
  BodyPlan planBodies(const StepWeights& w, const std::vector<char>& closing, std::vector<Contact>& contacts) const;
  void prepareSolve(const StepWeights& w);
  void advectLiquid(const StepWeights& w, FaceField<double>& free_velocity);
  void guess(const StepWeights& w, const FaceField<double>& free_velocity, CoupledState& start) const;
  CoupledReport solveWithLiquid(const StepWeights& w, const std::vector<Contact>& contacts,
                                const std::vector<JointStop>& stops, StepReport& report);
  CoupledReport solveWithDrives(const StepWeights& w, JointDrives& drives,
                                const std::function<CoupledReport(FaceField<double>&)>& solve);
  void takeMeans(const StepWeights& w, const std::vector<Wrench>& liquid_before);
  void takeJointMeans(const StepWeights& w);
  void moveLiquid(const StepWeights& w, StepReport& report);
  void enterImages();
  void moveAssembly(int root, std::vector<RigidBody>& bodies) const;
  void setBodies(std::vector<RigidBody> bodies, int changed);
  void requireJoint(int body) const;
  void prepareGeometry();
  void tellDepartures(StepReport& report);
  void measureLiquidMotion(StepReport& report);
  void measureState(StepReport& report) const;
  void tellModel(ModelChoice& model) const;

  Scene scene;
  std::vector<std::string> warnings;
  MacGrid grid;
  TankWalls walls;
  SolidSampler sampler;
  SolidFractions solids;  // at the bodies' present poses, from a solve on with the liquid that sticks to them
  bool predicted = false;  // second order: `solids` are at the poses that were solved with
  BodyPlan plan;           // of the last solve
  std::vector<FreeSurface> step_surface;
  FaceField<double> carried;  // velocity that the liquid at each face of the solve had at the start of the step
  // Within a sub-step only, kept for their memory.
  struct Scratch {
    FaceField<double> free_velocity;
    // Until the solve has converged what is to come, from then on what was; its velocities are work space before the
    // solve and after what was has served.
    CoupledState other;
    FaceMask known_before, known;
    double typical_viscosity = 0.0;  // Pa s, of the solve, of a non-Newtonian liquid
    std::vector<JointMode> joint_modes;
  } scratch;
  CoupledSystem system;
  ContactLaws laws;
  ViscosityLaw viscosity_law;
  std::unique_ptr<ContactDetector> detector;
  std::vector<Wrench> wrenches;
  std::vector<JointCommand> commands;
  double target_volume = 0.0;  // m^3
  // Of the liquid that stuck to the bodies in the last solve, at their poses then.
  double sticking_energy = 0.0;  // J
  Eigen::Vector3d sticking_momentum = Eigen::Vector3d::Zero();
  SimulationState state;
  SavedState before;  // the last output step, if this one takes several sub-steps
  StepReport report;
};

}  // namespace monolith
