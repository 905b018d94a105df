#include "simulation/simulation.h"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "coupling/coupled_system.h"
#include "fluid/advection.h"
#include "rigid/contact.h"
#include "rigid/overlap.h"
#include "simulation/body_motion.h"
#include "simulation/contact_laws.h"
#include "simulation/liquid_state.h"
#include "simulation/non_newtonian.h"
#include "simulation/time_stepping.h"

namespace monolith {
namespace {

constexpr double kMeshResolution = 0.5;     // of a cell: spacing of the distance grid of meshes
constexpr double kOverlapTolerance = 0.05;  // of a cell, at the start
constexpr int kLargestSubsteps = 64;
// The first solve starts from nothing that it could correct later.
constexpr double kFirstTolerance = 1e-4;
constexpr double kClosingTolerance = 1e-3;  // of a cell: a gap that closes by less within a step is no impact
// Steps of backward Euler: one in which the velocity jumps, and one for the next to continue.
constexpr int kStepsAfterSet = 2;
constexpr int kStepsAfterImpact = 1;
// Parts of the very first step: the two of first order are short enough not to be seen in what follows.
constexpr std::array<double, 2> kFirstParts = {0.25, 0.25};

class StageClock {
 public:
  explicit StageClock(double& total) : total_(total), start_(std::chrono::steady_clock::now()) {}
  ~StageClock() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_;
};

// Everything that a step may change, and that an uncommitted step must leave.
struct State {
  double time = 0.0;
  long step = 0;
  std::vector<RigidBody> bodies;
  std::vector<FreeSurface> surface;  // exactly one; a vector because it has no default
  CoupledState coupled;
  std::array<std::vector<std::uint8_t>, 3> known;
  FaceField<double> acceleration;           // m/s^2, of the liquid's particles, mean over the last sub-step
  std::vector<Vector6d> body_acceleration;  // likewise
  std::vector<Wrench> mean_liquid, mean_contact;  // over the last output step
  double liquid_speed = 0.0;                // m/s, no component of the velocity is larger
  double last_dt = 0.0;                     // s, of the last sub-step
  int euler_steps = kStepsAfterSet;         // sub-steps of backward Euler that are due
  std::size_t substeps = 0;
  bool started = false;
  double typical_viscosity = 0.0;  // Pa s, of a non-Newtonian liquid
};

}  // namespace

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
  bool nonNewtonian() const { return hasLiquid() && !viscosity_law.constant(); }
  bool noSlip() const { return viscosity_law.most() > 0.0; }
  double bodySpeed() const;
  bool substep(double dt, StepReport& report);
  bool secondOrder() const { return scene.solver.time_stepping == TimeStepping::kBdf2; }
  StepWeights weights(double dt) const;
  double contactReach(double dt) const;
  BodyPlan planBodies(const StepWeights& w, const std::vector<char>& closing, std::vector<Contact>& contacts) const;
  void prepareSolve(const StepWeights& w);
  void advectLiquid(const StepWeights& w, FaceField<double>& free_velocity);
  CoupledReport solveWithLiquid(const StepWeights& w, const std::vector<Contact>& contacts, StepReport& report);
  void takeMeans(const StepWeights& w, const std::vector<Wrench>& liquid_before);
  void moveLiquid(const StepWeights& w, const FaceField<double>& velocity_before, StepReport& report);
  void prepareGeometry();
  void measure(StepReport& report) const;

  Scene scene;
  MacGrid grid;
  TankWalls walls;
  SolidSampler sampler;
  SolidFractions solids;       // at the bodies' present poses, sticking liquid not yet attached; but see `predicted`
  bool predicted = false;      // second order: of `solids` only what cells have, of the poses that were solved with
  BodyPlan plan;               // of the last solve
  SolidFractions step_solids;  // as the last solve used them
  std::vector<FreeSurface> step_surface;
  FaceField<double> carried;   // velocity that the liquid at each face had at the start of the step
  CoupledSystem system;
  ContactLaws laws;
  ViscosityLaw viscosity_law;
  std::unique_ptr<ContactDetector> detector;
  std::vector<Wrench> wrenches;
  double target_volume = 0.0;  // m^3
  // Of the liquid that stuck to the bodies in the last solve, at their poses then.
  double sticking_energy = 0.0;  // J
  Eigen::Vector3d sticking_momentum = Eigen::Vector3d::Zero();
  State state;
  StepReport report;
};

Simulation::Simulation(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) { impl_->initialise(); }
Simulation::~Simulation() = default;

void Simulation::Impl::initialise() {
  state = State();
  report = StepReport();
  for (const BodyDescription& body : scene.bodies) {
    state.bodies.push_back(makeRigidBody(body, kMeshResolution * grid.h));
  }
  const std::string overlaps = describeOverlaps(state.bodies, walls, kOverlapTolerance * grid.h);
  if (!overlaps.empty())
    throw SceneError(scene.source + ": bodies overlap at the start, expected them apart:\n" + overlaps);
  detector = std::make_unique<ContactDetector>(state.bodies, walls);
  wrenches.assign(state.bodies.size(), Wrench());
  state.surface.emplace_back(grid, scene.liquid.fill_level, scene.liquid.boxes);
  for (auto& field : state.coupled.velocity) field.assign(grid.lattice.size, 0.0);
  for (auto& field : state.known) field.assign(grid.lattice.size, 1);
  state.coupled.pressure = hydrostaticPressure(grid, state.surface[0], scene.liquid.density, scene.gravity);
  state.coupled.liquid.assign(state.bodies.size(), Wrench());
  state.coupled.contact.assign(state.bodies.size(), Wrench());
  state.mean_liquid = state.coupled.liquid;
  state.mean_contact = state.coupled.contact;
  prepareGeometry();
  target_volume = state.surface[0].volume(solids.cell_fluid);
  state.typical_viscosity = viscosity_law.viscosity(0.0);
}

void Simulation::Impl::prepareGeometry() {
  predicted = false;
  sampler.sample(state.bodies, solids);
  state.surface[0].extendIntoSolids(solids.cell_distance);
}

double Simulation::Impl::bodySpeed() const {
  double speed = 0.0;
  for (const RigidBody& body : state.bodies) {
    const double reach = body.distance->bounds().translated(-body.p_BBcm).sizes().norm();
    speed = std::max(speed, body.twist.head<3>().norm() + 0.5 * reach * body.twist.tail<3>().norm());
  }
  return speed;
}

StepWeights Simulation::Impl::weights(double dt) const {
  return secondOrder() && state.euler_steps == 0 ? bdf2Weights(dt, state.last_dt) : eulerWeights(dt);
}

// Whatever could touch within the step: at present speeds, and what gravity and wrenches add.
double Simulation::Impl::contactReach(double dt) const {
  double reach = bodySpeed() + scene.gravity.norm() * dt;
  for (const Vector6d& twist : planEuler(state.bodies, scene.gravity, wrenches, state.time, dt).free_twists) {
    reach = std::max(reach, twist.head<3>().norm());
  }
  return std::min(2.0 * reach * dt, scene.tank.size.norm()) + 0.05 * grid.h;
}

BodyPlan Simulation::Impl::planBodies(const StepWeights& w, const std::vector<char>& closing,
                                      std::vector<Contact>& contacts) const {
  if (w.order == 1) return planEuler(state.bodies, scene.gravity, wrenches, state.time, w.dt);
  const BodyPast past{state.body_acceleration, state.coupled.liquid, state.coupled.contact};
  return planSecondOrder(state.bodies, scene.gravity, wrenches, past, state.time, w, closing, contacts);
}

// Geometry of the solve.
void Simulation::Impl::prepareSolve(const StepWeights& w) {
  if (w.order == 1) {
    if (predicted) prepareGeometry();
    step_surface = state.surface;
    step_solids = solids;
    return;
  }
  step_surface = state.surface;
  sampler.sample(plan.bodies, step_solids);
  step_surface[0].advect(state.coupled.velocity, w.dt, state.liquid_speed);
  step_surface[0].extendIntoSolids(step_solids.cell_distance);
}

void Simulation::Impl::advectLiquid(const StepWeights& w, FaceField<double>& free_velocity) {
  if (w.order == 2 && hasLiquid()) {
    FaceField<double> gained;
    advectAccelerated(grid, state.coupled.velocity, state.acceleration, state.known, w.dt, carried, gained);
    free_velocity = carried;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < gained[a].size(); ++i) free_velocity[a][i] += w.carry * w.dt * gained[a][i];
    }
  } else {
    advectVelocity(grid, state.coupled.velocity, state.known, w.dt, carried);
    free_velocity = carried;
  }
  for (int a = 0; a < 3; ++a) {
    if (scene.gravity[a] == 0.0) continue;
    for (double& u : free_velocity[a]) u += w.implicit * scene.gravity[a];
  }
}

CoupledReport Simulation::Impl::solveWithLiquid(const StepWeights& w, const std::vector<Contact>& contacts,
                                                StepReport& step) {
  const LiquidDescription& liquid = scene.liquid;
  FaceField<double> free_velocity;
  {
    const StageClock clock(step.times.advection);
    advectLiquid(w, free_velocity);
  }
  {
    const StageClock clock(step.times.geometry);
    prepareSolve(w);
    const auto& distance = step_surface[0].distance();
    if (nonNewtonian()) {
      system.assembleVariable(step_solids, plan.bodies, distance, liquid.density, state.typical_viscosity, w.implicit);
    } else {
      system.assemble(step_solids, plan.bodies, distance, liquid.density, liquid.dynamic_viscosity, w.implicit);
    }
  }
  const StageClock clock(step.times.solve);
  std::vector<Contact> scaled = contacts;  // the solve divides gaps by what it takes for the step
  for (Contact& contact : scaled) contact.gap *= w.implicit / w.dt;
  CoupledOptions options;
  options.tolerance = scene.solver.tolerance * (state.started ? 1.0 : kFirstTolerance);
  options.maximum_iterations = scene.solver.maximum_iterations;
  state.coupled.twists.resize(state.bodies.size());
  for (std::size_t b = 0; b < state.bodies.size(); ++b) state.coupled.twists[b] = state.bodies[b].twist;
  const auto solve = [&](const CoupledOptions& with) {
    return system.solve(free_velocity, plan.free_twists, scaled, laws.of(contacts), scene.gravity, with, state.coupled);
  };
  if (!nonNewtonian()) return solve(options);
  RheologyReport rheology;
  const CoupledReport solved =
      solveNonNewtonian(system, viscosity_law, state.typical_viscosity, liquid.rheology.maximum_iterations,
                        scene.solver.tolerance, options, solve, state.coupled, rheology);
  step.rheology_iterations += rheology.iterations;
  state.typical_viscosity = rheology.typical_viscosity;
  return solved;
}

// The solve's wrenches are the impulses over the part of the step that is implicit; what is kept are means over it.
void Simulation::Impl::takeMeans(const StepWeights& w, const std::vector<Wrench>& liquid_before) {
  const double part = w.implicit / w.dt;
  state.body_acceleration.resize(state.bodies.size());
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    state.body_acceleration[b] = (state.coupled.twists[b] - state.bodies[b].twist) / w.dt;
    Wrench& liquid = state.coupled.liquid[b];
    liquid.force = part * liquid.force + w.carry * liquid_before[b].force;
    liquid.torque = part * liquid.torque + w.carry * liquid_before[b].torque;
    Wrench& contact = state.coupled.contact[b];
    contact.force *= part;
    contact.torque *= part;
    const double share = w.dt / scene.time_step;
    state.mean_liquid[b].force += share * liquid.force;
    state.mean_liquid[b].torque += share * liquid.torque;
    state.mean_contact[b].force += share * contact.force;
    state.mean_contact[b].torque += share * contact.torque;
  }
}

void Simulation::Impl::moveLiquid(const StepWeights& w, const FaceField<double>& velocity_before, StepReport& step) {
  double speed = 0.0;
  for (int a = 0; a < 3; ++a) {
    double largest = 0.0;
    for (const double u : state.coupled.velocity[a]) largest = std::max(largest, std::abs(u));
    speed += largest * largest;
  }
  step.maximum_speed = std::sqrt(speed);
  // As far as a trajectory of this step reaches, and no further than the tank.
  const int most = *std::max_element(grid.lattice.n.begin(), grid.lattice.n.end());
  const double reach = std::ceil(std::max(step.maximum_speed, bodySpeed()) * w.dt / grid.h);
  const int layers = static_cast<int>(std::min(reach, static_cast<double>(most))) + 3;
  std::vector<RigidBody> moving = plan.bodies;
  for (std::size_t b = 0; b < moving.size(); ++b) moving[b].twist = state.coupled.twists[b];
  const auto known_before = state.known;
  completeVelocity(grid, system.problem(), step_solids, moving, layers, noSlip(), nullptr, state.coupled.velocity,
                   state.known);
  if (secondOrder()) {
    for (std::size_t b = 0; b < moving.size(); ++b) moving[b].twist = state.body_acceleration[b];
    FaceField<double>& acceleration = state.acceleration;
    for (int a = 0; a < 3; ++a) {
      acceleration[a].resize(grid.lattice.size);
      for (std::size_t i = 0; i < grid.lattice.size; ++i) {
        acceleration[a][i] = (state.coupled.velocity[a][i] - carried[a][i]) / w.dt;
      }
    }
    std::array<std::vector<std::uint8_t>, 3> known;
    completeVelocity(grid, system.problem(), step_solids, moving, layers, noSlip(), &known_before, acceleration, known);
  }
  if (w.order == 2) {
    FaceField<double> mean = velocity_before;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < grid.lattice.size; ++i) mean[a][i] = 0.5 * (mean[a][i] + state.coupled.velocity[a][i]);
    }
    state.surface[0].advect(mean, w.dt, std::max(step.maximum_speed, state.liquid_speed));
    // The poses of the solve are those of now but for dt^2/2 times the acceleration.
    solids.cell_distance = step_solids.cell_distance;
    solids.cell_fluid = step_solids.cell_fluid;
    state.surface[0].extendIntoSolids(solids.cell_distance);
    predicted = true;
  } else {
    state.surface[0].advect(state.coupled.velocity, w.dt, step.maximum_speed);
    prepareGeometry();
  }
  state.liquid_speed = step.maximum_speed;
  step.volume_correction += state.surface[0].correctVolume(target_volume, solids.cell_fluid);
}

bool Simulation::Impl::substep(double dt, StepReport& step) {
  const StepWeights w = weights(dt);
  std::vector<Contact> contacts;
  std::vector<char> closing;
  {
    const StageClock clock(step.times.contact);
    contacts = detector->detect(state.bodies, contactReach(dt));
    closing = closingBodies(state.bodies, contacts, dt, kClosingTolerance * grid.h);
    for (const Contact& contact : contacts) step.penetration = std::max(step.penetration, -contact.gap);
    plan = planBodies(w, closing, contacts);
  }
  const std::vector<Wrench> liquid_before = state.coupled.liquid;
  const FaceField<double> velocity_before = w.order == 2 ? state.coupled.velocity : FaceField<double>();
  const CoupledReport solved = solveWithLiquid(w, contacts, step);
  step.iterations += solved.iterations;
  step.liquid_solves += solved.solves;
  step.friction_iterations += solved.friction_iterations;
  step.residual = std::max(step.residual, solved.residual);
  step.divergence = std::max(step.divergence, solved.divergence);
  if (solved.status != CoupledReport::Status::kConverged) {
    step.status =
        solved.status == CoupledReport::Status::kInconsistent ? SolveStatus::kInconsistent : SolveStatus::kNotConverged;
    step.message = solved.message;
    return false;
  }
  state.started = true;
  sticking_energy = system.stickingEnergy(state.coupled.twists);
  sticking_momentum = system.stickingMomentum(state.coupled.twists);
  step.model.liquid = hasLiquid();
  step.model.viscosity = hasLiquid() && noSlip();
  step.model.non_newtonian = nonNewtonian();
  step.model.free_surface = hasLiquid() && !state.surface[0].full();
  step.model.time_order = w.order;
  step.model.coupled_bodies = system.coupledBodies();
  step.model.contacts = static_cast<int>(contacts.size());
  step.model.friction = std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return laws.of(contact.body_a, contact.body_b).friction > 0.0;
  });

  takeMeans(w, liquid_before);
  if (w.order == 2) {
    finishSecondOrder(plan, contacts, state.coupled.twists, dt, state.bodies);
  } else {
    finishEuler(state.coupled.twists, dt, state.bodies);
  }
  const bool impact = std::find(closing.begin(), closing.end(), 1) != closing.end();
  state.euler_steps = impact ? kStepsAfterImpact : std::max(0, state.euler_steps - 1);
  state.last_dt = dt;
  ++state.substeps;
  if (hasLiquid()) {
    const StageClock clock(step.times.surface);
    moveLiquid(w, velocity_before, step);
  }
  state.time += dt;
  return true;
}

void Simulation::Impl::measure(StepReport& step) const {
  if (hasLiquid()) {
    step.liquid_volume = state.surface[0].volume(solids.cell_fluid);
    const LiquidBudget budget = liquidBudget(grid, system.problem().liquidMass(), state.coupled.velocity,
                                             state.surface[0], solids.cell_fluid, scene.liquid.density, scene.gravity);
    step.kinetic_energy = budget.kinetic + sticking_energy;
    step.potential_energy = budget.potential;
    step.liquid_momentum = budget.momentum + sticking_momentum;
  }
  for (const RigidBody& body : state.bodies) {
    if (body.motion != BodyMotion::kFree) continue;
    const Eigen::Vector3d spin = body.twist.tail<3>();
    step.kinetic_energy +=
        0.5 * body.mass * body.twist.head<3>().squaredNorm() + 0.5 * spin.dot(body.worldInertia() * spin);
    step.potential_energy -= body.mass * scene.gravity.dot(body.p_WBcm);
  }
}

const Scene& Simulation::scene() const { return impl_->scene; }
double Simulation::time() const { return impl_->state.time; }
const StepReport& Simulation::report() const { return impl_->report; }
const std::vector<RigidBody>& Simulation::bodies() const { return impl_->state.bodies; }

StepReport Simulation::step() {
  Impl& m = *impl_;
  const int threads_before = omp_get_max_threads();
  if (m.scene.solver.threads > 0) omp_set_num_threads(m.scene.solver.threads);
  const State before = m.state;
  m.state.mean_liquid.assign(m.state.bodies.size(), Wrench());
  m.state.mean_contact.assign(m.state.bodies.size(), Wrench());
  StepReport step;
  double left = m.scene.time_step;
  {
    const StageClock clock(step.times.total);
    bool good = true;
    while (good && left > 1e-9 * m.scene.time_step) {
      // As many equal sub-steps as the present speeds ask for; looked at anew after each.
      const double speed = std::max(m.bodySpeed(), step.substeps > 0 ? step.maximum_speed : m.report.maximum_speed);
      const double wanted = std::ceil(left * speed / (m.scene.solver.cfl * m.grid.h) - 1e-9);
      const double count = std::clamp(wanted, 1.0, static_cast<double>(kLargestSubsteps));
      double dt = left / count;
      if (m.secondOrder() && m.state.substeps < kFirstParts.size()) {
        dt = std::min(dt, kFirstParts[m.state.substeps] * m.scene.time_step);
      }
      good = m.substep(dt, step);
      ++step.substeps;
      left -= dt;
    }
    if (good) {
      step.status = SolveStatus::kConverged;
      m.state.step = before.step + 1;
      m.state.time = static_cast<double>(m.state.step) * m.scene.time_step;
      m.measure(step);
    } else {
      m.state = before;
      m.prepareGeometry();
    }
  }
  step.step = m.state.step;
  step.time = m.state.time;
  omp_set_num_threads(threads_before);
  m.report = step;
  return step;
}

std::vector<BodyState> Simulation::bodyStates() const {
  std::vector<BodyState> out;
  for (std::size_t b = 0; b < impl_->state.bodies.size(); ++b) {
    const RigidBody& body = impl_->state.bodies[b];
    BodyState s;
    s.X_WB = body.pose();
    s.velocity = body.velocityAt(s.X_WB.translation());
    s.angular_velocity = body.twist.tail<3>();
    s.liquid = impl_->state.mean_liquid[b];
    s.contact = impl_->state.mean_contact[b];
    out.push_back(s);
  }
  return out;
}

void Simulation::setWrench(int body, const Wrench& wrench) {
  if (body < 0 || body >= static_cast<int>(impl_->wrenches.size())) {
    throw std::invalid_argument("body index " + std::to_string(body) + ": expected 0 to " +
                                std::to_string(static_cast<int>(impl_->wrenches.size()) - 1));
  }
  if (!wrench.force.allFinite() || !wrench.torque.allFinite()) {
    throw std::invalid_argument("wrench on '" + impl_->state.bodies[body].name + "': expected finite numbers");
  }
  impl_->wrenches[body] = wrench;
}

void Simulation::setBodyState(int body, const Eigen::Isometry3d& X_WB, const Eigen::Vector3d& velocity,
                              const Eigen::Vector3d& angular_velocity) {
  Impl& m = *impl_;
  if (body < 0 || body >= static_cast<int>(m.state.bodies.size())) {
    throw std::invalid_argument("body index " + std::to_string(body) + ": expected 0 to " +
                                std::to_string(static_cast<int>(m.state.bodies.size()) - 1));
  }
  const std::string& name = m.state.bodies[body].name;
  if (!X_WB.matrix().allFinite() || !velocity.allFinite() || !angular_velocity.allFinite()) {
    throw std::invalid_argument("state of '" + name + "': expected finite numbers");
  }
  std::vector<RigidBody> bodies = m.state.bodies;
  RigidBody& moved = bodies[body];
  moved.q_WB = Eigen::Quaterniond(X_WB.linear()).normalized();
  moved.p_WBcm = X_WB.translation() + moved.q_WB * moved.p_BBcm;
  moved.twist.head<3>() = velocity + angular_velocity.cross(moved.p_WBcm - X_WB.translation());
  moved.twist.tail<3>() = angular_velocity;
  const std::string overlaps = describeOverlaps(bodies, m.walls, kOverlapTolerance * m.grid.h);
  if (!overlaps.empty()) {
    throw std::invalid_argument("state of '" + name +
                                "': expected a pose inside the tank and clear of other bodies:\n" + overlaps);
  }
  m.state.bodies = bodies;
  m.state.euler_steps = kStepsAfterSet;
  m.prepareGeometry();
}

std::vector<SurfacePoint> Simulation::surfacePoints() const {
  return sampleSurface(impl_->grid, impl_->state.surface[0], impl_->solids.cell_distance,
                       impl_->state.coupled.velocity);
}

Eigen::Vector3d Simulation::liquidVelocity(const Eigen::Vector3d& point) const {
  const MacGrid& grid = impl_->grid;
  return velocityAt(grid.lattice, impl_->state.coupled.velocity, (point - grid.origin) / grid.h);
}

void Simulation::reset() { impl_->initialise(); }

}  // namespace monolith
