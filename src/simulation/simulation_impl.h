#pragma once
// What the sources of Simulation share: its state and its parts.

#include <chrono>
#include <memory>

#include "coupling/coupled_system.h"
#include "coupling/sticking_liquid.h"
#include "fluid/free_surface.h"
#include "rigid/contact.h"
#include "simulation/body_motion.h"
#include "simulation/contact_laws.h"
#include "simulation/liquid_state.h"
#include "simulation/non_newtonian.h"
#include "simulation/simulation.h"
#include "simulation/time_stepping.h"

namespace monolith {

// Steps of backward Euler after a state that was set: one in which the velocity jumps, and one for the next to
// continue.
constexpr int kStepsAfterSet = 2;
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

// Everything that a step may change, and that an uncommitted step must leave.
struct SimulationState {
  double time = 0.0;
  long step = 0;
  std::vector<RigidBody> bodies;
  std::vector<FreeSurface> surface;  // exactly one; a vector because it has no default
  CoupledState coupled;
  FaceMask known;
  FaceField<double> acceleration;                 // m/s^2, of the liquid's particles, mean over the last sub-step
  std::vector<Vector6d> body_acceleration;        // likewise
  std::vector<char> departed;                     // bodies whose departure from the tank has been told
  std::vector<Vector6d> stuck_twists;             // of the liquid that sticks to each body, set or not since
  std::vector<Wrench> mean_liquid, mean_contact;  // over the last output step
  double liquid_speed = 0.0;                      // m/s, no component of the velocity is larger
  double fastest = 0.0;                           // m/s, see typicalSpeed()
  double last_dt = 0.0;                           // s, of the last sub-step
  int euler_steps = kStepsAfterSet;               // sub-steps of backward Euler that are due
  std::size_t substeps = 0;
  bool started = false;
  double typical_viscosity = 0.0;  // Pa s; of a non-Newtonian liquid that of the last solve
  double liquid_energy = 0.0;      // J, kinetic, after the last output step
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
  BodyPlan planBodies(const StepWeights& w, const std::vector<char>& closing, std::vector<Contact>& contacts) const;
  void prepareSolve(const StepWeights& w);
  void advectLiquid(const StepWeights& w, FaceField<double>& free_velocity);
  void guess(const StepWeights& w, const FaceField<double>& free_velocity, CoupledState& start) const;
  CoupledReport solveWithLiquid(const StepWeights& w, const std::vector<Contact>& contacts, StepReport& report);
  void takeMeans(const StepWeights& w, const std::vector<Wrench>& liquid_before);
  void moveLiquid(const StepWeights& w, StepReport& report);
  void enterImages();
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
  } scratch;
  CoupledSystem system;
  ContactLaws laws;
  ViscosityLaw viscosity_law;
  std::unique_ptr<ContactDetector> detector;
  std::vector<Wrench> wrenches;
  double target_volume = 0.0;  // m^3
  // Of the liquid that stuck to the bodies in the last solve, at their poses then.
  double sticking_energy = 0.0;  // J
  Eigen::Vector3d sticking_momentum = Eigen::Vector3d::Zero();
  SimulationState state;
  SimulationState before;  // the last output step, if this one takes several sub-steps
  StepReport report;
};

}  // namespace monolith
