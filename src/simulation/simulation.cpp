#include "simulation/simulation.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include "fluid/advection.h"
#include "rigid/overlap.h"
#include "scene/joint_motion.h"
#include "simulation/resolution.h"
#include "simulation/simulation_impl.h"

namespace monolith {
namespace {

constexpr double kMeshResolution = 0.5;     // of a cell: spacing of the distance grid of meshes
// Of a cell. What overlaps is pushed apart, and the speed that it takes stays: no more than round-off of poses.
constexpr double kOverlapAtStart = 1e-3;
constexpr int kLargestSubsteps = 64;
// Sub-steps in a period of what oscillates as prescribed: of fewer the velocities do not tell how it moves.
constexpr double kSubstepsInPeriod = 10.0;
// How often in a step a sub-step that fails is tried again, half as long: contacts that do not settle where the bodies
// are may do so a little further on, and a viscous number that is too large gets smaller.
constexpr int kMostRetries = 6;
// Parts of the very first step: the two of first order are short enough not to be seen in what follows.
constexpr std::array<double, 2> kFirstParts = {0.25, 0.25};

// Of points in W from the nearest body, in cell widths; infinite where that is more than a cell.
SolidDistance solidDistance(const MacGrid& grid, const std::vector<RigidBody>& bodies) {
  struct Placed {
    std::shared_ptr<const SignedDistance> shape;
    Eigen::Isometry3d X_BW;
    Eigen::AlignedBox3d around;  // W
  };
  std::vector<Placed> placed;
  for (const RigidBody& body : bodies) {
    Eigen::AlignedBox3d around = body.distance->bounds().transformed(body.pose());
    around.extend((around.min().array() - grid.h).matrix().eval());
    around.extend((around.max().array() + grid.h).matrix().eval());
    placed.push_back({body.distance, body.pose().inverse(), around});
  }
  return [grid, placed](const Eigen::Vector3d& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const Placed& body : placed) {
      const Eigen::Vector3d image = x + grid.toNearestImage(x, body.around.center());
      if (body.around.contains(image)) least = std::min(least, body.shape->distance(body.X_BW * image) / grid.h);
    }
    return least;
  };
}

// Hz, of what is prescribed to a body or its joint; 0: nothing that oscillates.
double oscillationOf(const RigidBody& body) {
  if (body.joint && body.joint->prescribed && body.joint->prescribed->amplitude != 0.0) {
    return body.joint->prescribed->frequency;
  }
  const bool prescribed = body.motion == BodyMotion::kPrescribed && !body.prescribed.amplitude.isZero(0.0);
  return prescribed ? body.prescribed.frequency : 0.0;
}

// Empty if a step may have as many sub-steps as a prescribed oscillation asks for.
std::string describeFastOscillation(const RigidBody& body, double time_step) {
  const double highest = kLargestSubsteps / (kSubstepsInPeriod * time_step);
  const double frequency = oscillationOf(body);
  if (frequency <= highest) return "";
  std::ostringstream text;
  const std::string key = body.joint ? "joints." + body.joint->name + ".prescribed" : "prescribed";
  text << "body '" << body.name << "': " << key << ".frequency: value " << frequency
       << " Hz: what it drives is inaccurate; expected at most " << highest << " Hz, so that time_step/"
       << kLargestSubsteps << ", the shortest sub-step, is a tenth of the period";
  return text.str();
}

// Empty unless a joint has a servo that can do nothing.
std::string describeWeakServo(const RigidBody& body) {
  if (!body.hasFreeJoint() || body.joint->most_effort > 0.0 || !body.joint->servo.any()) return "";
  return "joint '" + body.joint->name + "' of '" + body.name +
         "': its URDF limits the effort to 0: expected more, with a servo";
}

// Empty if a step may have as many sub-steps as keep the surface's shortest waves from growing.
std::string describeLongStep(double time_step, double cell_width, double gravity, double kinematic_viscosity) {
  const double longest = kLargestSubsteps * stableWaveStep(cell_width, gravity, kinematic_viscosity);
  if (time_step <= longest) return "";
  std::ostringstream text;
  text << "time_step: value " << time_step << " s: expected at most " << longest << " s, " << kLargestSubsteps
       << " sub-steps: in longer ones the shortest waves on the liquid, of two cells (tank.cell_width " << cell_width
       << " m), grow until it is gone";
  return text.str();
}

}  // namespace

Simulation::Simulation(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) { impl_->initialise(); }
Simulation::~Simulation() = default;

void Simulation::Impl::initialise() {
  state = SimulationState();
  report = StepReport();
  warnings.clear();
  for (const BodyDescription& body : scene.bodies) {
    state.bodies.push_back(makeRigidBody(body, kMeshResolution * grid.h));
    RigidBody& made = state.bodies.back();
    made.p_WBcm = walls.imageInside(made.p_WBcm);
    const std::string weak = describeWeakServo(made);
    if (!weak.empty()) warnings.push_back(scene.source + ": " + weak);
    const std::string fast = describeFastOscillation(made, scene.time_step);
    if (!fast.empty()) warnings.push_back(scene.source + ": " + fast);
    if (!scene.liquid.any()) continue;
    const BodyResolution resolution = judgeResolution(grid.h, made);
    made.thinnest = resolution.thinnest;
    if (!resolution.warning.empty()) warnings.push_back(scene.source + ": " + resolution.warning);
  }
  for (RigidBody& body : state.bodies) {
    if (!body.joint || !body.joint->prescribed) continue;
    body.joint_velocity = prescribedVelocity(*body.joint->prescribed, 0.0);
    // Beyond what nothing moves else neither does it.
    if (state.bodies[body.joint->parent].motion != BodyMotion::kFree) body.motion = BodyMotion::kPrescribed;
  }
  const std::vector<int> roots = rootsOf(state.bodies);
  std::set<int> assemblies;
  for (std::size_t b = 0; b < roots.size(); ++b) {
    if (state.bodies[b].joint) assemblies.insert(roots[b]);
  }
  for (const int root : assemblies) moveAssembly(root, state.bodies);
  const std::string overlaps = describeOverlaps(state.bodies, walls, kOverlapAtStart * grid.h);
  if (!overlaps.empty())
    throw SceneError(scene.source + ": bodies overlap at the start, expected them apart:\n" + overlaps);
  detector = std::make_unique<ContactDetector>(state.bodies, walls);
  wrenches.assign(state.bodies.size(), Wrench());
  commands.clear();
  for (const RigidBody& body : state.bodies) commands.push_back({0.0, body.joint_position, 0.0});
  state.surface.emplace_back(grid, scene.liquid.fill_level, scene.liquid.boxes, solidDistance(grid, state.bodies));
  if (state.surface[0].empty() && scene.liquid.any()) {
    std::ostringstream text;
    text << scene.source
         << ": liquid: fill_level and boxes hold the centre of no cell, expected more than half of tank/"
         << "cell_width, which is " << grid.h << " m, or no liquid at all";
    throw SceneError(text.str());
  }
  for (auto& field : state.coupled.velocity) field.assign(grid.lattice.size, 0.0);
  for (auto& field : state.known) field.assign(grid.lattice.size, 1);
  state.coupled.pressure = hydrostaticPressure(grid, state.surface[0], scene.liquid.density, scene.gravity);
  state.departed.assign(state.bodies.size(), 0);
  state.stuck_twists.assign(state.bodies.size(), Vector6d::Zero());
  state.coupled.liquid.assign(state.bodies.size(), Wrench());
  state.coupled.contact.assign(state.bodies.size(), Wrench());
  state.mean_liquid = state.coupled.liquid;
  state.mean_contact = state.coupled.contact;
  state.mean_effort.assign(state.bodies.size(), 0.0);
  state.joints.assign(state.bodies.size(), Wrench());
  state.joint_modes.assign(state.bodies.size(), JointMode());
  sampler.forget();
  system.forget();
  prepareGeometry();
  target_volume = state.surface[0].volume(solids.cell_fluid);
  state.typical_viscosity = viscosity_law.viscosity(0.0);
  const double gravity = scene.gravity.norm();
  if (hasSurface() && gravity > 0.0) {
    const double viscosity = state.typical_viscosity / scene.liquid.density;
    const std::string too_long = describeLongStep(scene.time_step, grid.h, gravity, viscosity);
    if (!too_long.empty()) throw SceneError(scene.source + ": " + too_long);
  }
  measureState(report);
  tellModel(report.model);
}

void Simulation::Impl::prepareGeometry() {
  predicted = false;
  sampler.sample(state.bodies, solids);
  state.surface[0].extendIntoSolids(solids.cell_distance, solids.distance);
}

// What a sub-step should be at most, s.
double Simulation::Impl::longestStep() const {
  double longest = scene.solver.cfl * grid.h / std::max(bodySpeed(), state.liquid_speed);
  for (const RigidBody& body : state.bodies) {
    const double frequency = oscillationOf(body);
    if (frequency > 0.0) longest = std::min(longest, 1.0 / (kSubstepsInPeriod * frequency));
  }
  const double gravity = scene.gravity.norm();
  if (!hasSurface() || gravity == 0.0) return longest;
  return std::min(longest, longestWaveStep(grid.h, gravity, state.typical_viscosity / scene.liquid.density));
}

double Simulation::Impl::bodySpeed() const {
  double speed = 0.0;
  for (const RigidBody& body : state.bodies) {
    speed = std::max(speed, body.fastestPoint(body.twist));
  }
  return speed;
}

// To what gravity brings something within a cell. Without gravity, what there has been so far, of bodies, liquid, or
// what a wrench would bring a body to within a cell: it doesn't fall again, so that liquid which slips doesn't come to
// stick where a body slows down.
double Simulation::Impl::typicalSpeed() const {
  const double gravity = scene.gravity.norm();
  if (gravity > 0.0) return std::sqrt(gravity * grid.h);
  double speed = std::max({state.fastest, bodySpeed(), state.liquid_speed});
  const std::vector<Wrench> acting = actingWrenches();
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const RigidBody& body = state.bodies[b];
    if (body.motion != BodyMotion::kFree) continue;
    speed = std::max(speed, std::sqrt(acting[b].force.norm() / body.mass * grid.h));
  }
  return speed;
}

// With the masses of the last solve, which only a step that is committed leaves.
void Simulation::Impl::measureLiquidMotion(StepReport& step) {
  if (!hasLiquid()) return;
  const LiquidMotion motion =
      liquidMotion(grid, system.problem().liquidMass(), state.coupled.velocity, scene.liquid.density);
  state.liquid_energy = motion.energy + sticking_energy;
  step.liquid_momentum = motion.momentum + sticking_momentum;
}

// What the report tells of a state that no step needs to have led to.
void Simulation::Impl::measureState(StepReport& step) const {
  step.liquid_volume = 0.0;
  step.kinetic_energy = state.liquid_energy;
  step.potential_energy = 0.0;
  if (hasLiquid()) {
    step.liquid_volume = state.surface[0].volume(solids.cell_fluid);
    step.potential_energy = liquidPotential(grid, state.surface[0], solids, scene.liquid.density, scene.gravity);
  }
  for (const RigidBody& body : state.bodies) {
    if (body.motion != BodyMotion::kFree) continue;
    step.kinetic_energy += kineticEnergy(body);
    step.potential_energy -= body.mass * scene.gravity.dot(body.p_WBcm);
  }
}

// What is prescribed to move out of the tank does: said once, as the liquid's volume does not tell why it changes.
void Simulation::Impl::tellDepartures(StepReport& step) {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    if (state.departed[b]) continue;
    const std::string line = describeDeparture(state.bodies[b], walls, kMostIntrusion * grid.h);
    if (line.empty()) continue;
    state.departed[b] = 1;
    step.warning += (step.warning.empty() ? "" : "\n") + line;
  }
}

// What the state alone tells of the next step's model, or of the last one's.
void Simulation::Impl::tellModel(ModelChoice& model) const {
  model.liquid = hasLiquid();
  model.viscosity = hasLiquid() && noSlip();
  model.non_newtonian = nonNewtonian();
  model.free_surface = hasSurface();
}

const Scene& Simulation::scene() const { return impl_->scene; }
const std::vector<std::string>& Simulation::warnings() const { return impl_->warnings; }
double Simulation::time() const { return impl_->state.time; }
const StepReport& Simulation::report() const { return impl_->report; }
const std::vector<RigidBody>& Simulation::bodies() const { return impl_->state.bodies; }

StepReport Simulation::step() {
  Impl& m = *impl_;
  const int threads_before = omp_get_max_threads();
  if (m.scene.solver.threads > 0) omp_set_num_threads(m.scene.solver.threads);
  const std::vector<Wrench> last_liquid = m.state.mean_liquid, last_contact = m.state.mean_contact;
  const std::vector<double> last_effort = m.state.mean_effort;
  m.state.mean_liquid.assign(m.state.bodies.size(), Wrench());
  m.state.mean_contact.assign(m.state.bodies.size(), Wrench());
  m.state.mean_effort.assign(m.state.bodies.size(), 0.0);
  StepReport step;
  double left = m.scene.time_step;
  {
    const StageClock clock(step.times.total);
    const bool was_predicted = m.predicted;
    // What is left of a solve is where the bodies were to be.
    const auto putBack = [&m](bool predicted) {
      m.sampler.sample(m.state.bodies, m.solids);
      m.predicted = predicted;
    };
    double longest = m.scene.time_step;
    bool saved = false;
    bool good = true;
    while (good && left > 1e-9 * m.scene.time_step) {
      // As many equal sub-steps as the present speeds ask for, and the surface's waves; looked at anew after each.
      const double wanted = std::ceil(left / m.longestStep() - 1e-9);
      const double most = std::ceil(kLargestSubsteps * left / m.scene.time_step - 1e-9);
      const double count = std::clamp(wanted, 1.0, most);
      double dt = std::min(left / count, longest);
      if (m.secondOrder() && m.state.substeps < kFirstParts.size()) {
        dt = std::min(dt, kFirstParts[m.state.substeps] * m.scene.time_step);
      }
      // A sub-step that fails leaves the state as it was; those before it have to be taken back. Where there are none,
      // the memory of a copy is given back.
      if (!saved) {
        saved = left - dt > 1e-9 * m.scene.time_step;
        if (saved) {
          m.before.save(m.grid.lattice, m.state);
        } else {
          m.before.clear();
        }
      }
      const bool predicted = m.predicted;
      const StepReport so_far = step;
      try {
        good = m.substep(dt, step);
        if (!good && step.status == SolveStatus::kNotConverged && step.retries < kMostRetries) {
          ++step.retries;
          step.message.clear();
          // What it took counts, not what it led to.
          step.residual = so_far.residual;
          step.contact_residual = so_far.contact_residual;
          step.divergence = so_far.divergence;
          putBack(predicted);
          longest = 0.5 * dt;
          good = true;
          continue;
        }
      } catch (const std::exception& error) {
        step.status = SolveStatus::kNotConverged;
        step.message = error.what();
        good = false;
      }
      ++step.substeps;
      left -= dt;
    }
    if (good) {
      step.status = SolveStatus::kConverged;
      ++m.state.step;
      m.state.time = static_cast<double>(m.state.step) * m.scene.time_step;
      m.measureLiquidMotion(step);
      m.measureState(step);
      m.tellDepartures(step);
    } else {
      if (step.substeps > 1) m.before.restore(m.state);
      m.state.mean_liquid = last_liquid;
      m.state.mean_contact = last_contact;
      m.state.mean_effort = last_effort;
      putBack(was_predicted);
      // Of the state, which is that of the last step.
      step.liquid_volume = m.report.liquid_volume;
      step.volume_correction = m.report.volume_correction;
      step.kinetic_energy = m.report.kinetic_energy;
      step.potential_energy = m.report.potential_energy;
      step.liquid_momentum = m.report.liquid_momentum;
      step.maximum_speed = m.report.maximum_speed;
      m.tellModel(step.model);
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
  // As the joints move now: a step leaves twists for the poses that it solved at, whose momentum is the bodies'.
  std::vector<RigidBody> bodies = impl_->state.bodies;
  moveWithJoints(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
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

std::vector<JointState> Simulation::jointStates() const {
  std::vector<JointState> out;
  const SimulationState& state = impl_->state;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const RigidBody& body = state.bodies[b];
    if (!body.joint) continue;
    out.push_back({static_cast<int>(b), body.joint_position, body.joint_velocity, state.mean_effort[b]});
  }
  return out;
}

std::vector<SurfacePoint> Simulation::surfacePoints() const {
  return sampleSurface(impl_->grid, impl_->state.surface[0], impl_->solids.cell_distance,
                       impl_->state.coupled.velocity);
}

Eigen::Vector3d Simulation::liquidVelocity(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) throw std::invalid_argument("point in the liquid: expected finite numbers");
  const MacGrid& grid = impl_->grid;
  return velocityAt(grid.lattice, impl_->state.coupled.velocity, (point - grid.origin) / grid.h);
}

void Simulation::reset() { impl_->initialise(); }

}  // namespace monolith
