// One sub-step; substep() at the end of this file is the algorithm, what it calls stands above it in that order.

#include <algorithm>
#include <cmath>

#include "fluid/advection.h"
#include "simulation/continued_motion.h"
#include "simulation/simulation_impl.h"
#include "simulation/velocity_limits.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// The first solve starts from nothing that it could correct later.
constexpr double kFirstTolerance = 1e-4;
constexpr double kClosingTolerance = 1e-3;  // of a cell: a gap that closes by less within a step is no impact
// Per cell, with which the liquid's motion goes on into the air where only its own slope tells how: of sqrt(gravity h),
// the speed of the shortest waves, and of gravity. A wave of 32 cells length and an amplitude of a third of a cell has
// so much. Neither depends on the step, which would cost an order of accuracy.
constexpr double kSteepestVelocity = 0.03;
constexpr double kSteepestRate = 0.15;
// Of sqrt(gravity h), by which the surface may be faster than limitCutFaces() has it: what is limited is no wave.
constexpr double kSlack = 0.3;
// After the step of an impact one of backward Euler, for the next to continue.
constexpr int kStepsAfterImpact = 1;
constexpr double kRoundOff = 1e-6;  // of a length of sub-steps that just fits

}  // namespace

StepWeights Simulation::Impl::weights(double dt) const {
  // Where liquid crosses more cells, the accelerations of particles are no longer resolved, and going on with them is
  // unstable where velocity jumps within a cell (a lid's edge).
  const bool slow = state.liquid_speed * dt <= (1.0 + kRoundOff) * kMostSecondOrderCells * grid.h;
  return secondOrder() && slow && state.euler_steps == 0 ? bdf2Weights(dt, state.last_dt) : eulerWeights(dt);
}

// Whatever could touch within the step: at present speeds, also those at which the liquid may carry a light body along,
// and what gravity and wrenches add.
double Simulation::Impl::contactReach(double dt) const {
  double reach = std::max(bodySpeed(), state.liquid_speed) + scene.gravity.norm() * dt;
  const BodyPlan next = planEuler(state.bodies, scene.gravity, actingWrenches(), state.time, dt);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    reach = std::max(reach, state.bodies[b].fastestPoint(next.free_twists[b]));
  }
  reach = std::max(reach, servoSpeed(dt));
  return std::min(2.0 * reach * dt, scene.tank.size.norm()) + 0.05 * grid.h;
}

BodyPlan Simulation::Impl::planBodies(const StepWeights& w, const std::vector<char>& closing,
                                      std::vector<Contact>& contacts) const {
  if (w.order == 1) return planEuler(state.bodies, scene.gravity, actingWrenches(), state.time, w.dt);
  const BodyPast past{state.body_acceleration, state.coupled.liquid, state.coupled.contact, state.joints};
  return planSecondOrder(state.bodies, scene.gravity, actingWrenches(), past, state.time, w, closing, walls.period(),
                         contacts);
}

// Geometry of the solve. Of the state nothing changes: the step may fail.
void Simulation::Impl::prepareSolve(const StepWeights& w) {
  step_surface = state.surface;
  if (w.order == 1) {
    if (!predicted) return;
    sampler.sample(state.bodies, solids);
    step_surface[0].extendIntoSolids(solids.cell_distance, solids.distance);
    return;
  }
  sampler.sample(plan.bodies, solids);
  if (hasSurface()) {
    FaceField<double>& ahead = scratch.other.velocity;
    const double part = surfaceAhead(state.liquid_speed, scene.gravity.norm(), grid.h) * w.dt;
    for (int a = 0; a < 3; ++a) {
      const std::vector<double>&u = state.coupled.velocity[a], &rate = state.acceleration[a];
      ahead[a].resize(u.size());
#pragma omp parallel for simd schedule(static)
      for (std::size_t i = 0; i < u.size(); ++i) ahead[a][i] = u[i] + part * rate[i];
    }
    step_surface[0].advect(ahead, w.dt, largestSpeed(ahead), solids.cell_distance);
  }
  step_surface[0].extendIntoSolids(solids.cell_distance, solids.distance);
}

// Of the faces that the solve has, to which it is assembled. What the accelerations that particles keep would add is in
// free_velocity with the rest.
void Simulation::Impl::advectLiquid(const StepWeights& w, FaceField<double>& free_velocity) {
  auto& wanted = scratch.known;
  for (int a = 0; a < 3; ++a) {
    const double* mass = system.problem().coefficients.mass[a].data();
    const std::uint8_t* known = state.known[a].data();
    wanted[a].resize(grid.lattice.size);
    std::uint8_t* to = wanted[a].data();
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < grid.lattice.size; ++i) to[i] = known[i] & (mass[i] > 0.0 ? 1 : 0);
  }
  const bool gains = w.order == 2 && hasLiquid();
  if (gains) {
    advectAccelerated(grid, state.coupled.velocity, state.acceleration, wanted, w.dt, carried, free_velocity,
                      scratch.other.velocity);
  } else {
    advectVelocity(grid, state.coupled.velocity, wanted, w.dt, carried);
  }
  for (int a = 0; a < 3; ++a) {
    const std::size_t size = carried[a].size();
    free_velocity[a].resize(size);
    const double falls = w.implicit * scene.gravity[a];
    const double part = gains ? w.carry * w.dt : 0.0;
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < size; ++i) {
      free_velocity[a][i] = carried[a][i] + falls + (gains ? part * free_velocity[a][i] : 0.0);
    }
  }
}

// The solve starts from what there is after another step of the same accelerations.
void Simulation::Impl::guess(const StepWeights& w, const FaceField<double>& free_velocity, CoupledState& start) const {
  for (int a = 0; a < 3; ++a) copyField(state.coupled.velocity[a], start.velocity[a]);
  copyField(state.coupled.pressure, start.pressure);
  start.liquid = state.coupled.liquid;
  start.contact = state.coupled.contact;
  start.contact_forces = state.coupled.contact_forces;
  start.twists.resize(state.bodies.size());
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    start.twists[b] = state.bodies[b].twist;
    if (w.order == 2) start.twists[b] += w.dt * state.body_acceleration[b];
  }
  if (w.order == 1 || !hasLiquid()) return;
  for (int a = 0; a < 3; ++a) {
    const double falls = w.implicit * scene.gravity[a];
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < free_velocity[a].size(); ++i) {
      const double part = free_velocity[a][i] - carried[a][i] - falls;
      if (state.known[a][i]) start.velocity[a][i] = carried[a][i] + part / w.carry;
    }
  }
}

CoupledReport Simulation::Impl::solveWithLiquid(const StepWeights& w, const std::vector<Contact>& contacts,
                                                const std::vector<JointStop>& stops, StepReport& step) {
  const LiquidDescription& liquid = scene.liquid;
  FaceField<double>& free_velocity = scratch.free_velocity;
  JointDrives drives(state.bodies, commands, w, state.joint_modes);
  {
    const StageClock clock(step.times.geometry);
    prepareSolve(w);
    system.setStickingViscosity(stickingViscosity(liquid.density, typicalSpeed(), grid.h));
    system.setJointResistance(drives.resistances());
    const auto& distance = step_surface[0].distance();
    if (nonNewtonian()) {
      system.assembleVariable(solids, plan.bodies, distance, liquid.density, state.typical_viscosity, w.implicit);
    } else {
      system.assemble(solids, plan.bodies, distance, liquid.density, liquid.dynamic_viscosity, w.implicit);
    }
    // A body that was set has left the liquid at it as it was. Then steps are of first order.
    if (w.order == 1) system.setStuckTwists(state.stuck_twists);
  }
  {
    const StageClock clock(step.times.advection);
    advectLiquid(w, free_velocity);
  }
  const StageClock clock(step.times.solve);
  std::vector<Contact> scaled = contacts;  // the solve divides gaps by what it takes for the step
  for (Contact& contact : scaled) contact.gap *= w.implicit / w.dt;
  std::vector<JointStop> scaled_stops = stops;
  for (JointStop& stop : scaled_stops) stop.gap *= w.implicit / w.dt;
  CoupledOptions options;
  const double wanted = scene.solver.tolerance;
  options.tolerance = state.started ? wanted : std::min(wanted, std::max(kFirstTolerance * wanted, kLeastTolerance));
  options.maximum_iterations = scene.solver.maximum_iterations;
  CoupledState& solution = scratch.other;
  guess(w, free_velocity, solution);
  const auto solve = [&](FaceField<double>& right, const CoupledOptions& with) {
    return system.solve(right, plan.free_twists, scaled, laws.of(contacts), scaled_stops, scene.gravity, with,
                        solution);
  };
  const auto solveOnce = [&](FaceField<double>& right) {
    if (!nonNewtonian()) return solve(right, options);
    RheologyReport rheology;
    const auto solveAgain = [&](const CoupledOptions& with) {
      FaceField<double> again = right;
      return solve(again, with);
    };
    const CoupledReport solved =
        solveNonNewtonian(system, viscosity_law, state.typical_viscosity, liquid.rheology.maximum_iterations,
                          scene.solver.tolerance, options, solveAgain, solution, rheology);
    step.rheology_iterations += rheology.iterations;
    scratch.typical_viscosity = rheology.typical_viscosity;
    return solved;
  };
  scratch.joint_modes = state.joint_modes;
  return drives.any() ? solveWithDrives(w, drives, solveOnce) : solveOnce(free_velocity);
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

void Simulation::Impl::moveLiquid(const StepWeights& w, StepReport& step) {
  std::swap(scratch.known_before, state.known);
  markResolved(system.problem(), state.known);
  limitSlivers(solids, grid, state.coupled.velocity, state.known);
  if (hasSurface()) {
    std::vector<double> body_speeds;
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
      body_speeds.push_back(plan.bodies[b].fastestPoint(state.coupled.twists[b]));
    }
    limitCutFaces(system.problem().liquidMass(), solids, grid, body_speeds,
                  kSlack * std::sqrt(scene.gravity.norm() * grid.h), state.coupled.velocity, state.known);
  }
  step.maximum_speed = largestSpeed(state.coupled.velocity);
  // As far as a trajectory of this step reaches, and no further than the tank.
  const int most = *std::max_element(grid.lattice.n.begin(), grid.lattice.n.end());
  const double reach = std::ceil(std::max(step.maximum_speed, bodySpeed()) * w.dt / grid.h);
  const int layers = static_cast<int>(std::min(reach, static_cast<double>(most))) + 3;
  const auto complete = [&](const std::vector<LiquidField>& fields, FaceMask& known) {
    completeMotion(solids, grid, plan.bodies, layers, system.problem().sticks, noSlip(), fields, known,
                   scratch.known_before);
  };
  const double gravity = scene.gravity.norm();
  const LiquidField velocity{&state.coupled.velocity, &state.coupled.twists,
                             kSteepestVelocity * std::sqrt(gravity * grid.h)};
  if (!secondOrder()) {
    complete({velocity}, state.known);
  } else {
    FaceField<double>& acceleration = state.acceleration;
    for (int a = 0; a < 3; ++a) {
      acceleration[a].resize(grid.lattice.size);
#pragma omp parallel for simd schedule(static)
      for (std::size_t i = 0; i < grid.lattice.size; ++i) {
        acceleration[a][i] = (state.coupled.velocity[a][i] - carried[a][i]) / w.dt;
      }
    }
    // Known where the velocity was before and is now: everywhere, as a rule.
    const LiquidField rate{&acceleration, &state.body_acceleration, kSteepestRate * gravity};
    if (intersect(state.known, scratch.known_before, scratch.known)) {
      complete({velocity}, state.known);
      complete({rate}, scratch.known);
    } else {
      complete({velocity, rate}, state.known);
    }
  }
  if (w.order == 2) {
    if (hasSurface()) {
      FaceField<double>& mean = scratch.other.velocity;
      for (int a = 0; a < 3; ++a) {
#pragma omp parallel for simd schedule(static)
        for (std::size_t i = 0; i < grid.lattice.size; ++i) {
          mean[a][i] = 0.5 * (mean[a][i] + state.coupled.velocity[a][i]);
        }
      }
      state.surface[0].advect(mean, w.dt, std::max(step.maximum_speed, state.liquid_speed), solids.cell_distance);
    }
    // The poses of the solve are those of now but for dt^2/2 times the acceleration.
    state.surface[0].extendIntoSolids(solids.cell_distance, solids.distance);
    predicted = true;
  } else {
    std::swap(state.surface, step_surface);  // it was extended into the bodies where they were
    state.surface[0].advect(state.coupled.velocity, w.dt, step.maximum_speed, solids.cell_distance);
    prepareGeometry();
  }
  state.liquid_speed = step.maximum_speed;
  step.volume_correction += state.surface[0].correctVolume(target_volume, solids.cell_fluid, solids.fluid);
}

// Bodies that left the tank along a periodic axis are put to their images in it. The forces of contacts go with body_a,
// for the next ones to be found where they are.
void Simulation::Impl::enterImages() {
  std::vector<Eigen::Vector3d> shift;
  for (RigidBody& body : state.bodies) {
    const Eigen::Vector3d image = walls.imageInside(body.p_WBcm);
    shift.emplace_back(image - body.p_WBcm);
    body.p_WBcm = image;
  }
  for (ContactForce& force : state.coupled.contact_forces.contacts) {
    Contact& contact = force.contact;
    contact.point += shift[contact.body_a];
    if (contact.body_b != Contact::kWall) contact.shift_b += shift[contact.body_a] - shift[contact.body_b];
  }
}

bool Simulation::Impl::substep(double dt, StepReport& step) {
  const StepWeights w = weights(dt);
  std::vector<Contact> contacts;
  std::vector<JointStop> stops;
  std::vector<char> closing;
  {
    const StageClock clock(step.times.contact);
    contacts = detector->detect(state.bodies, contactReach(dt));
    stops = jointStops(state.bodies);
    closing = closingBodies(state.bodies, contacts, stops, dt, kClosingTolerance * grid.h);
    for (const Contact& contact : contacts) step.penetration = std::max(step.penetration, -contact.gap);
    plan = planBodies(w, closing, contacts);
  }
  const CoupledReport solved = solveWithLiquid(w, contacts, stops, step);
  step.iterations += solved.iterations;
  step.liquid_solves += solved.solves;
  step.friction_iterations += solved.friction_iterations;
  step.residual = std::max(step.residual, solved.residual);
  step.contact_residual = std::max(step.contact_residual, solved.contact_residual);
  step.divergence = std::max(step.divergence, solved.divergence);
  if (solved.status != SolveStatus::kConverged) {
    step.status = solved.status;
    step.message = solved.message;
    return false;
  }
  // On a copy: of a step that does not hold nothing is kept.
  std::vector<RigidBody> moved = state.bodies;
  if (w.order == 2) {
    const bool rebound = std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
      return closing[contact.body_a] && laws.of(contact.body_a, contact.body_b).restitution > 0.0;
    });
    finishSecondOrder(plan, contacts, rebound, scratch.other.twists, dt, walls.period(), moved);
  } else {
    finishEuler(plan, scratch.other.twists, dt, walls.period(), moved);
  }
  step.message = describeIntrusion(plan, contacts, walls, scratch.other.twists, dt, kMostIntrusion * grid.h,
                                   state.bodies, moved);
  if (!step.message.empty()) {
    step.status = SolveStatus::kNotConverged;
    return false;
  }
  state.fastest = typicalSpeed();
  takeJointMeans(w);
  state.joint_modes = scratch.joint_modes;
  std::swap(state.coupled, scratch.other);
  if (nonNewtonian()) state.typical_viscosity = scratch.typical_viscosity;
  state.started = true;
  sticking_energy = system.stickingEnergy(state.coupled.twists);
  sticking_momentum = system.stickingMomentum(state.coupled.twists);
  tellModel(step.model);
  step.model.time_order = w.order;
  step.model.coupled_bodies = system.coupledBodies();
  step.model.joints = system.problem().coordinates.joints();
  step.model.contacts = static_cast<int>(contacts.size());
  step.model.friction = std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return laws.of(contact.body_a, contact.body_b).friction > 0.0;
  });

  takeMeans(w, scratch.other.liquid);
  state.bodies = std::move(moved);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) state.stuck_twists[b] = state.bodies[b].twist;
  enterImages();
  const bool impact = std::find(closing.begin(), closing.end(), 1) != closing.end();
  state.euler_steps = impact ? kStepsAfterImpact : std::max(0, state.euler_steps - 1);
  state.last_dt = dt;
  ++state.substeps;
  if (hasLiquid()) {
    const StageClock clock(step.times.surface);
    moveLiquid(w, step);
  }
  state.time += dt;
  return true;
}

}  // namespace monolith
