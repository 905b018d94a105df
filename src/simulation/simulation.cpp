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
#include "simulation/contact_laws.h"
#include "simulation/liquid_state.h"
#include "simulation/non_newtonian.h"

namespace monolith {
namespace {

constexpr double kMeshResolution = 0.5;     // of a cell: spacing of the distance grid of meshes
constexpr double kOverlapTolerance = 0.05;  // of a cell, at the start
constexpr int kLargestSubsteps = 64;
// The first solve starts from nothing that it could correct later.
constexpr double kFirstTolerance = 1e-4;

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
  CoupledReport solveWithLiquid(double dt, const std::vector<Vector6d>& free_twists,
                                const std::vector<Contact>& contacts, StepReport& report);
  void prepareGeometry();
  void measure(StepReport& report) const;

  Scene scene;
  MacGrid grid;
  TankWalls walls;
  SolidSampler sampler;
  SolidFractions solids;       // at the bodies' present poses, sticking liquid not yet attached
  SolidFractions step_solids;  // as the last solve used them
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
  prepareGeometry();
  target_volume = state.surface[0].volume(solids.cell_fluid);
  state.typical_viscosity = viscosity_law.viscosity(0.0);
}

void Simulation::Impl::prepareGeometry() {
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

CoupledReport Simulation::Impl::solveWithLiquid(double dt, const std::vector<Vector6d>& free_twists,
                                                const std::vector<Contact>& contacts, StepReport& step) {
  const LiquidDescription& liquid = scene.liquid;
  FaceField<double> free_velocity;
  {
    const StageClock clock(step.times.advection);
    advectVelocity(grid, state.coupled.velocity, state.known, dt, free_velocity);
    for (int a = 0; a < 3; ++a) {
      if (scene.gravity[a] == 0.0) continue;
      for (double& u : free_velocity[a]) u += dt * scene.gravity[a];
    }
  }
  {
    const StageClock clock(step.times.geometry);
    step_solids = solids;
    if (nonNewtonian()) {
      system.assembleVariable(step_solids, state.bodies, state.surface[0].distance(), liquid.density,
                              state.typical_viscosity, dt);
    } else {
      system.assemble(step_solids, state.bodies, state.surface[0].distance(), liquid.density, liquid.dynamic_viscosity,
                      dt);
    }
  }
  const StageClock clock(step.times.solve);
  CoupledOptions options;
  options.tolerance = scene.solver.tolerance * (state.started ? 1.0 : kFirstTolerance);
  options.maximum_iterations = scene.solver.maximum_iterations;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) state.coupled.twists[b] = state.bodies[b].twist;
  const auto solve = [&](const CoupledOptions& with) {
    return system.solve(free_velocity, free_twists, contacts, laws.of(contacts), scene.gravity, with, state.coupled);
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

bool Simulation::Impl::substep(double dt, StepReport& step) {
  std::vector<Vector6d> free_twists;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const RigidBody& body = state.bodies[b];
    free_twists.push_back(body.motion == BodyMotion::kFree         ? freeTwist(body, scene.gravity, wrenches[b], dt)
                          : body.motion == BodyMotion::kPrescribed ? prescribedTwist(body, state.time + 0.5 * dt)
                                                                   : Vector6d(Vector6d::Zero()));
  }
  std::vector<Contact> contacts;
  {
    const StageClock clock(step.times.contact);
    // Whatever could touch within the step: at present speeds, and what gravity adds.
    double reach = bodySpeed() + scene.gravity.norm() * dt;
    for (const auto& twist : free_twists) reach = std::max(reach, twist.head<3>().norm());
    contacts = detector->detect(state.bodies, std::min(2.0 * reach * dt, scene.tank.size.norm()) + 0.05 * grid.h);
    for (const Contact& contact : contacts) step.penetration = std::max(step.penetration, -contact.gap);
  }
  state.coupled.twists.resize(state.bodies.size());
  const CoupledReport solved = solveWithLiquid(dt, free_twists, contacts, step);
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
  step.model.coupled_bodies = system.coupledBodies();
  step.model.contacts = static_cast<int>(contacts.size());
  step.model.friction = std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return laws.of(contact.body_a, contact.body_b).friction > 0.0;
  });

  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    state.bodies[b].twist = state.coupled.twists[b];
    advancePose(state.bodies[b], dt);
  }
  const StageClock clock(step.times.surface);
  if (hasLiquid()) {
    double speed = 0.0;
    for (int a = 0; a < 3; ++a) {
      double largest = 0.0;
      for (const double u : state.coupled.velocity[a]) largest = std::max(largest, std::abs(u));
      speed += largest * largest;
    }
    step.maximum_speed = std::sqrt(speed);
    // As far as a trajectory of this step reaches, and no further than the tank.
    const int most = *std::max_element(grid.lattice.n.begin(), grid.lattice.n.end());
    const double reach = std::ceil(std::max(step.maximum_speed, bodySpeed()) * dt / grid.h);
    const int layers = static_cast<int>(std::min(reach, static_cast<double>(most))) + 3;
    completeVelocity(grid, system.problem(), step_solids, state.bodies, layers, noSlip(), state.coupled.velocity,
                     state.known);
    state.surface[0].advect(state.coupled.velocity, dt, step.maximum_speed);
    prepareGeometry();
    step.volume_correction += state.surface[0].correctVolume(target_volume, solids.cell_fluid);
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
      const double dt = left / count;
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
    s.liquid = impl_->state.coupled.liquid[b];
    s.contact = impl_->state.coupled.contact[b];
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
  m.prepareGeometry();
}

void Simulation::setLiquidVelocity(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity) {
  FaceField<double> faces;
  setVelocity(impl_->grid, velocity, faces);
  impl_->state.coupled.velocity = std::move(faces);
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
