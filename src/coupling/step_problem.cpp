#include "coupling/step_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "coupling/fraction_coefficients.h"
#include "coupling/row_kinds.h"
#include "coupling/sticking_liquid.h"
#include "rigid/articulation.h"
#include "solve/blocked_sum.h"
#include "solve/velocity_multigrid.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

// Flux that a sealed region cannot take up, relative to the fluxes through its boundary: above, the motions are at
// fault, below, round-off.
constexpr double kFluxTolerance = 1e-7;

// `fractions`: less of a face than this does not tell the velocity of the liquid there (fraction_coefficients.h).
constexpr double kLeastResolved = 0.25;

// Where viscosity varies any level may be wanted.
double leastCoarsened(bool varies) { return varies ? 0.0 : kLeastCoarsenedNumber; }

}  // namespace

void StepProblem::assemble(SolidFractions& solids, const std::vector<RigidBody>& all_bodies,
                           const std::vector<double>& liquid_distance, double density, double viscosity, double step,
                           bool rates) {
  bodies = &all_bodies;
  dt = step;
  viscous_number = viscosity * dt / (density * grid.h * grid.h);
  impulse_scale = density * grid.cellVolume();
  pressure_scale = density * grid.h / dt;

  stuck_inertia.assign(all_bodies.size(), Matrix6d::Zero());
  stuck_twists.clear();
  for (const RigidBody& body : all_bodies) stuck_twists.push_back(body.twist);
  cell_viscosity.clear();
  if (discretisation == Discretisation::kFitted) {
    assembleFitted(solids, liquid_distance, rates);
  } else {
    assembleFractions(solids, liquid_distance, rates);
  }
  enclosed = moveEnclosedRows(grid, solids, all_bodies, coefficients, liquid_distance, rows);
  if (!sticks) dropIdleTurns(all_bodies, rows.divergence);
  op_.set(&coefficients, &rows);

  const std::vector<char> wet = rows.touched(all_bodies.size());
  free.clear();
  touched.clear();
  free_index.assign(all_bodies.size(), -1);
  twist_scale.clear();
  radius.clear();
  inertia.clear();
  for (std::size_t b = 0; b < all_bodies.size(); ++b) {
    if (all_bodies[b].motion != BodyMotion::kFree) continue;
    free_index[b] = static_cast<int>(free.size());
    free.push_back(static_cast<int>(b));
    touched.push_back(wet[b]);
    Matrix6d M = Matrix6d::Zero();
    M.topLeftCorner<3, 3>() = all_bodies[b].mass * Eigen::Matrix3d::Identity();
    M.bottomRightCorner<3, 3>() = all_bodies[b].worldInertia();
    M /= impulse_scale;
    inertia.push_back(M + stuck_inertia[b]);
    // A light body moves with the liquid that it displaces: that is its scale then.
    double displaced = 0.0;
    for (const double part : solids.bodies[b].cell) displaced += part;
    radius.push_back(std::cbrt(3.0 * displaced / (4.0 * M_PI)));
    const double radius2 = radius.back() * radius.back() * grid.h * grid.h;
    Vector6d scale;
    for (int d = 0; d < 6; ++d) scale[d] = std::sqrt(M(d, d) + displaced * (d < 3 ? 1.0 : 0.4 * radius2));
    twist_scale.push_back(scale);
  }
  setUnknowns();
  regions = findPressureRegions(coefficients, rows, coordinates);
}

void StepProblem::setUnknowns() {
  std::vector<double> resistance = joint_resistance;
  for (double& r : resistance) r /= impulse_scale;
  coordinates.set(*bodies, twist_scale, resistance);
  unknown_scale = Eigen::VectorXd::Ones(coordinates.size());
  for (const BodyCoordinates::Assembly& assembly : coordinates.assemblies()) {
    if (assembly.bodies.size() > 1) continue;  // scaled already
    unknown_scale.segment<6>(assembly.first) = twist_scale[free_index[assembly.bodies[0]]];
  }
}

Eigen::MatrixXd StepProblem::bodyInertia() const {
  const Eigen::SparseMatrix<double>& S = coordinates.S();
  std::vector<Eigen::Triplet<double>> blocks;
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (int k = 0; k < 36; ++k) {
      const auto first = static_cast<int>(6 * i);
      if (inertia[i](k) != 0.0) blocks.emplace_back(first + k % 6, first + k / 6, inertia[i](k));
    }
  }
  Eigen::SparseMatrix<double> M(S.rows(), S.rows());
  M.setFromTriplets(blocks.begin(), blocks.end());
  Eigen::MatrixXd out = Eigen::MatrixXd(Eigen::SparseMatrix<double>(S.transpose() * M * S));
  for (std::size_t b = 0; b < joint_resistance.size(); ++b) {
    if (joint_resistance[b] == 0.0 || !coordinates.hasJoint(b)) continue;
    const Eigen::VectorXd row = coordinates.jointRow(b);
    out += joint_resistance[b] / impulse_scale * row * row.transpose();
  }
  return out;
}

void StepProblem::addJointResistance(const std::vector<Vector6d>& twists, std::vector<Vector6d>& impulses) const {
  for (std::size_t b = 0; b < joint_resistance.size(); ++b) {
    if (joint_resistance[b] == 0.0 || !coordinates.hasJoint(b)) continue;
    const auto parent = static_cast<std::size_t>((*bodies)[b].joint->parent);
    const Vector6d row = jointRow((*bodies)[b]), reaction = carryMatrix(*bodies, b).transpose() * row;
    const double velocity = row.dot(twists[b]) - (free_index[parent] < 0 ? 0.0 : reaction.dot(twists[parent]));
    const double impulse = joint_resistance[b] / impulse_scale * velocity;
    impulses[b] += impulse * row;
    if (free_index[parent] >= 0) impulses[parent] -= impulse * reaction;
  }
}

void StepProblem::forget() {
  steady.forget();
  coarse.forget();
}

void StepProblem::assembleFitted(SolidFractions& solids, const std::vector<double>& liquid_distance, bool rates) {
  sticks = viscous_number > 0.0 && viscous_number * impulse_scale >= sticking_viscosity * dt * grid.h;
  stuck_inertia = sticks ? attachStickingLiquid(grid, *bodies, liquid_distance, solids)
                         : closeThinWalls(grid, *bodies, liquid_distance, solids);
  const StokesGeometry geometry{&solids.fluid, &solids.distance, &liquid_distance, &solids.cell_distance};
  const RowKinds found = findRowKinds(grid.lattice, solids.bodies, liquid_distance);
  if (rates) {
    steady.forget();
  } else {
    steady.update(grid.lattice, found.kinds, {viscous_number, sticks ? 1.0 : 0.0});
  }
  buildCoefficients(grid.lattice, geometry, viscous_number, coefficients, kinds_, rates ? &strain : nullptr,
                    rates ? nullptr : &steady);
  buildBodyRows(grid, solids, *bodies, geometry, coefficients, kinds_, rows);
  if (rates || !found.full || !coarse.serve(*bodies, viscous_number, grid.h)) {
    buildCoarseLevels(grid.lattice, geometry, viscous_number, leastCoarsened(rates), coarse.levels);
    coarse.built(*bodies, viscous_number, !rates && found.full);
  }
}

void StepProblem::assembleFractions(const SolidFractions& solids, const std::vector<double>& liquid_distance,
                                    bool rates) {
  sticks = viscous_number > 0.0;
  steady.forget();
  const FractionGeometry geometry = sampleFractions(grid, *bodies, solids, liquid_distance, viscous_number > 0.0);
  buildFractionCoefficients(grid.lattice, geometry, viscous_number, coefficients, rates ? &strain : nullptr);
  buildFractionRows(grid, solids, *bodies, coefficients, rows);
  buildCoarseFractionLevels(grid.lattice, geometry, liquid_distance, viscous_number, leastCoarsened(rates),
                            coarse.levels);
  coarse.built(*bodies, viscous_number, false);
  flux_share = geometry.fluid;
  const Lattice& l = grid.lattice;
  std::vector<std::uint8_t> has_pressure = coefficients.has_pressure;
  fillHalo(l, has_pressure);
  for (int a = 0; a < 3; ++a) {
    resolved_[a].assign(l.size, 0);
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto f = row; f < row + l.faceEnd(0); ++f) {
        if (!(coefficients.mass[a][f] > 0.0)) flux_share[a][f] = 0.0;
        resolved_[a][f] = flux_share[a][f] >= kLeastResolved && (has_pressure[f] || has_pressure[f - l.stride[a]]);
      }
    });
  }
  // mass U^2 = (W_F W_L) u^2
  liquid_mass_ = coefficients.mass;
  toUnknowns(liquid_mass_);
  toUnknowns(liquid_mass_);
}

void StepProblem::markResolved(int axis, std::ptrdiff_t row, int width, std::uint8_t* resolved) const {
  if (!resolved_[axis].empty()) {
    std::copy_n(resolved_[axis].data() + row, width, resolved);
    return;
  }
  const double* mass = coefficients.mass[axis].data() + row;
#pragma omp simd
  for (int i = 0; i < width; ++i) resolved[i] = mass[i] > 0.0 ? 1 : 0;
}

void StepProblem::toUnknowns(FaceField<double>& velocity) const {
  for (int a = 0; a < 3; ++a) {
    for (std::size_t f = 0; f < flux_share[a].size(); ++f) velocity[a][f] *= flux_share[a][f];
  }
}

void StepProblem::toVelocities(FaceField<double>& unknowns) const {
  for (int a = 0; a < 3; ++a) {
    for (std::size_t f = 0; f < flux_share[a].size(); ++f) {
      unknowns[a][f] = isResolved(a, f) ? unknowns[a][f] / flux_share[a][f] : 0.0;
    }
  }
}

Vector6d StepProblem::stickingTwist(std::size_t body, const Eigen::Vector3d& gravity) const {
  Vector6d twist = stuck_twists[body];
  twist.head<3>() += dt * gravity;
  return twist;
}

Vector6d StepProblem::enclosedImpulse(const EnclosedWeight& weight, const Eigen::Vector3d& gravity) const {
  return (dt / grid.h * gravity.dot(weight.offset)) * weight.coefficient;
}

std::string StepProblem::rightSide(FaceField<double> free_velocity, const std::vector<Vector6d>& free_twists,
                                   const Eigen::Vector3d& gravity, StepVector& rhs) {
  const Lattice& l = grid.lattice;
  rhs.velocity = std::move(free_velocity);
  for (int a = 0; a < 3; ++a) {
    const double* mass = coefficients.mass[a].data();
    const double* share = flux_share[a].empty() ? nullptr : flux_share[a].data();
    double* u = rhs.velocity[a].data();
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < l.size; ++i) u[i] = mass[i] * (share == nullptr ? u[i] : share[i] * u[i]);
  }
  assignZero(l.size, rhs.pressure);
  rhs.bodies.assign(bodies->size(), Vector6d::Zero());
  // What the prescribed motions do.
  given = coordinates.carried(*bodies, free_twists);
  std::vector<int> moved;
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    if (!given[b].isZero(0.0)) moved.push_back(static_cast<int>(b));
  }
  if (!moved.empty()) {
    StepVector prescribed, resistance;
    prescribed.resize(l, bodies->size());
    for (const int b : moved) prescribed.bodies[b] = given[b];
    op_.apply(prescribed, resistance);
    const auto take = [](const std::vector<double>& from, std::vector<double>& to) {
      for (std::size_t i = 0; i < to.size(); ++i) to[i] -= from[i];
    };
    for (int a = 0; a < 3; ++a) take(resistance.velocity[a], rhs.velocity[a]);
    take(resistance.pressure, rhs.pressure);
    for (std::size_t b = 0; b < bodies->size(); ++b) rhs.bodies[b] -= resistance.bodies[b];
  }
  for (auto& field : rhs.velocity) clearHalo(l, field);
  clearHalo(l, rhs.pressure);
  for (std::size_t i = 0; i < free.size(); ++i) {
    const std::size_t b = free[i];
    if (!given[b].isZero(0.0)) rhs.bodies[b] -= inertia[i] * given[b];
    rhs.bodies[b] += inertia[i] * free_twists[b] + stuck_inertia[b] * (stickingTwist(b, gravity) - free_twists[b]);
  }
  for (const EnclosedWeight& weight : enclosed) rhs.bodies[weight.body] += enclosedImpulse(weight, gravity);
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    if (free_index[b] < 0) rhs.bodies[b].setZero();
  }
  return balanceSealedRegions(rhs.pressure);
}

// Sealed regions: the prescribed flux must leave the volume as it is; round-off is removed from the right side.
std::string StepProblem::balanceSealedRegions(std::vector<double>& flux) const {
  for (const PressureRegion& region : regions) {
    if (!region.null_mode) continue;
    const double sum =
        region.sum([&](std::ptrdiff_t begin, std::ptrdiff_t end) { return sumOf(flux.data() + begin, end - begin); });
    const double size = region.sum([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      return std::accumulate(flux.begin() + begin, flux.begin() + end, 0.0,
                             [](double part, double f) { return part + std::abs(f); });
    });
    if (std::abs(sum) > kFluxTolerance * size && size > 1e-12) {
      std::ostringstream text;
      text << "a sealed region of liquid (" << region.cells << " cells, "
           << static_cast<double>(region.cells) * grid.cellVolume() << " m^3) would have to change its volume by "
           << sum * grid.h * grid.h << " m^3/s under the prescribed motion of";
      std::vector<char> named(bodies->size(), 0);
      std::vector<char> inside(grid.lattice.size, 0);
      for (const auto& run : region.runs) std::fill(inside.begin() + run.begin, inside.begin() + run.end, 1);
      for (const BodyRow& row : rows.divergence) {
        if (!inside[row.sample] || named[row.body] || free_index[row.body] >= 0) continue;
        named[row.body] = 1;
        text << " '" << (*bodies)[row.body].name << "'";
      }
      text << "; an incompressible liquid cannot";
      return text.str();
    }
    const double mean = sum / static_cast<double>(region.cells);
    region.forEachRun([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (auto c = begin; c < end; ++c) flux[c] -= mean;
    });
  }
  return {};
}

void StepProblem::apply(StepVector& x, StepVector& y) const {
  op_.apply(x, y);
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    const int i = free_index[b];
    if (i < 0) {
      y.bodies[b].setZero();
    } else {
      y.bodies[b] += inertia[i] * x.bodies[b];
    }
  }
  addJointResistance(x.bodies, y.bodies);
  for (auto& field : y.velocity) clearHalo(grid.lattice, field);
  clearHalo(grid.lattice, y.pressure);
}

void StepProblem::results(StepVector& x, const Eigen::Vector3d& gravity, std::vector<Wrench>& liquid,
                          double& divergence, std::vector<double>& work) const {
  std::vector<Vector6d> forces(bodies->size());
  op_.bodyForces(x, forces);
  divergence = op_.largestDivergence(x, work) / grid.h;
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    forces[b] += stuck_inertia[b] * (x.bodies[b] - stickingTwist(b, gravity));
  }
  for (const EnclosedWeight& weight : enclosed) forces[weight.body] -= enclosedImpulse(weight, gravity);
  const double force_scale = impulse_scale / dt;
  liquid.assign(bodies->size(), Wrench());
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    liquid[b].force = -force_scale * forces[b].head<3>();
    liquid[b].torque = -force_scale * forces[b].tail<3>();
  }
}

}  // namespace monolith
