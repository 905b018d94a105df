#include "coupling/coupled_system.h"

#include <algorithm>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "coupling/iterative_coupling.h"
#include "coupling/reference_solver.h"

namespace monolith {
namespace {

// An approach slower than what gravity adds in this many steps rests; it does not bounce.
constexpr double kRestingSteps = 2.0;

std::unique_ptr<StepSolver> makeSolver(SolverName name) {
  switch (name) {
    case SolverName::kDirect: return std::make_unique<DirectSolver>();
    case SolverName::kReference: return std::make_unique<ReferenceSolver>();
    case SolverName::kFast: break;
  }
  return std::make_unique<FastSolver>();
}

}  // namespace

struct CoupledSystem::Impl {
  Impl(const MacGrid& grid, SolverName name, CouplingName coupling_name, Discretisation discretisation)
      : problem(grid, discretisation), solver_name(name), solver(makeSolver(name)), coupling(coupling_name) {}

  StepProblem problem;
  SolverName solver_name;
  std::unique_ptr<StepSolver> solver;
  CouplingName coupling;
  VariableViscosity viscosity;
  StepVector rhs, x;      // without velocities between solves
  double rhs_norm = 0.0;  // of the last solve, where viscosity varies

  // Of the right side in rhs.
  CoupledReport solve(const std::vector<Contact>& contacts, const std::vector<ContactLaw>& laws,
                      const std::vector<JointStop>& stops, const Eigen::Vector3d& gravity,
                      const CoupledOptions& options, CoupledState& state);
  // Velocities and pressures of a state where they are unknowns; all twists.
  void load(const CoupledState& state) {
    x.velocity = state.velocity;
    x.pressure = state.pressure;
    x.bodies = state.twists;
    clearOthers();
  }
  // The same without a copy: the state's fields are x's until giveBack().
  void take(CoupledState& state) {
    x.velocity.swap(state.velocity);
    x.pressure.swap(state.pressure);
    x.bodies = state.twists;
    clearOthers();
  }
  void giveBack(CoupledState& state) {
    problem.toVelocities(x.velocity);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < x.pressure.size(); ++i) x.pressure[i] *= problem.pressure_scale;
    state.velocity.swap(x.velocity);
    state.pressure.swap(x.pressure);
  }

 private:
  void clearOthers() {
    const Lattice& l = problem.grid.lattice;
    for (int a = 0; a < 3; ++a) {
#pragma omp parallel for schedule(static)
      for (std::size_t i = 0; i < l.size; ++i) {
        if (!(problem.coefficients.mass[a][i] > 0.0)) x.velocity[a][i] = 0.0;
      }
      clearHalo(l, x.velocity[a]);
    }
    problem.toUnknowns(x.velocity);
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < l.size; ++i) {
      x.pressure[i] = problem.coefficients.has_pressure[i] ? x.pressure[i] / problem.pressure_scale : 0.0;
    }
    clearHalo(l, x.pressure);
  }
};

CoupledSystem::CoupledSystem(const MacGrid& grid, SolverName solver, CouplingName coupling,
                             Discretisation discretisation)
    : impl_(std::make_unique<Impl>(grid, solver, coupling, discretisation)) {}
CoupledSystem::~CoupledSystem() = default;

void CoupledSystem::setStickingViscosity(double viscosity) { impl_->problem.sticking_viscosity = viscosity; }

void CoupledSystem::forget() {
  impl_->problem.forget();
  impl_->solver = makeSolver(impl_->solver_name);
}

const StepProblem& CoupledSystem::problem() const { return impl_->problem; }

double CoupledSystem::stickingEnergy(const std::vector<Vector6d>& twists) const {
  const StepProblem& p = impl_->problem;
  double sum = 0.0;
  for (std::size_t b = 0; b < twists.size(); ++b) sum += 0.5 * twists[b].dot(p.stuck_inertia[b] * twists[b]);
  return p.impulse_scale * sum;
}

Eigen::Vector3d CoupledSystem::stickingMomentum(const std::vector<Vector6d>& twists) const {
  const StepProblem& p = impl_->problem;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t b = 0; b < twists.size(); ++b) sum += (p.stuck_inertia[b] * twists[b]).head<3>();
  return p.impulse_scale * sum;
}

int CoupledSystem::coupledBodies() const {
  const std::vector<char> touched = impl_->problem.rows.touched(impl_->problem.free_index.size());
  return static_cast<int>(std::count(touched.begin(), touched.end(), 1));
}

void CoupledSystem::assemble(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                             const std::vector<double>& liquid_distance, double density, double viscosity, double dt) {
  impl_->problem.assemble(solids, bodies, liquid_distance, density, viscosity, dt);
  impl_->solver->prepare(impl_->problem);
}

void CoupledSystem::assembleVariable(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                                     const std::vector<double>& liquid_distance, double density, double reference,
                                     double dt) {
  impl_->problem.assemble(solids, bodies, liquid_distance, density, reference, dt, true);
  impl_->viscosity.start(impl_->problem, reference);
}

void CoupledSystem::setJointResistance(const std::vector<double>& resistance) {
  impl_->problem.joint_resistance = resistance;
}

void CoupledSystem::changeJointResistance(const std::vector<double>& resistance) {
  impl_->problem.joint_resistance = resistance;
  impl_->problem.setUnknowns();
  // Where viscosity varies, that is to come.
  if (impl_->problem.cell_viscosity.empty()) impl_->solver->prepare(impl_->problem);
}

void CoupledSystem::setStuckTwists(const std::vector<Vector6d>& twists) { impl_->problem.stuck_twists = twists; }

void CoupledSystem::evaluateViscosity(const ViscosityLaw& law, const CoupledState& state, ViscosityField& field) {
  impl_->load(state);
  impl_->viscosity.evaluate(impl_->problem, law, impl_->x, field);
}

void CoupledSystem::setViscosity(const ViscosityField& field) {
  impl_->viscosity.apply(field, impl_->problem);
  impl_->solver->prepare(impl_->problem);
}

double CoupledSystem::viscousChange(const CoupledState& solution, const ViscosityField& next) {
  impl_->load(solution);
  const double scale = impl_->rhs_norm;
  const double change = impl_->viscosity.change(impl_->problem, next, impl_->x);
  return scale > 0.0 ? change / scale : change;
}

CoupledReport CoupledSystem::solve(FaceField<double>& free_velocity, const std::vector<Vector6d>& free_twists,
                                   const std::vector<Contact>& contacts, const std::vector<ContactLaw>& laws,
                                   const std::vector<JointStop>& stops, const Eigen::Vector3d& gravity,
                                   const CoupledOptions& options, CoupledState& state) {
  Impl& m = *impl_;
  CoupledReport report;
  report.message = m.problem.rightSide(std::move(free_velocity), free_twists, gravity, m.rhs);
  if (report.message.empty()) {
    report = m.solve(contacts, laws, stops, gravity, options, state);
  } else {
    report.status = SolveStatus::kInconsistent;
  }
  free_velocity = std::move(m.rhs.velocity);
  return report;
}

CoupledReport CoupledSystem::Impl::solve(const std::vector<Contact>& contacts, const std::vector<ContactLaw>& laws,
                                         const std::vector<JointStop>& stops, const Eigen::Vector3d& gravity,
                                         const CoupledOptions& options, CoupledState& state) {
  const StepProblem& p = problem;
  if (!p.cell_viscosity.empty()) rhs_norm = stepNorm(p, rhs);
  // Initial guess.
  take(state);
  for (std::size_t b = 0; b < p.bodies->size(); ++b) {
    if (p.free_index[b] < 0) x.bodies[b] = p.given[b];
  }

  const ContactRows rows = buildContactRows(p, contacts, laws, stops, kRestingSteps * gravity.norm() * p.dt);
  Eigen::VectorXd r = warmStart(p, rows, contacts, state.contact_forces);
  CoupledReport report = rows.count() == 0                      ? solver->solve(rhs, options, x)
                         : coupling == CouplingName::kIterative ? solveIteratively(*solver, p, rhs, rows, options, x, r)
                                                                : solver->solveWithContacts(rhs, rows, options, x, r);
  const bool converged = report.status == SolveStatus::kConverged;
  if (converged) {
    for (const int b : p.free) x.bodies[b] += p.given[b];
    state.twists = x.bodies;
    p.results(x, gravity, state.liquid, report.divergence, rhs.pressure);  // which has served
  }
  giveBack(state);
  if (!converged) return report;
  distributeImpulses(p, rows, contacts, r, state.contact_forces, state.contact);
  return report;
}

}  // namespace monolith
