#include "coupling/reference_solver.h"

#include <Eigen/IterativeLinearSolvers>
#include <functional>
#include <sstream>

#include "coupling/stress_system.h"
#include "solve/disc_qp.h"
#include "solve/frictional_contact.h"
#include "solve/lcp.h"
#include "solve/mprgp.h"

namespace monolith {
namespace {

constexpr int kMaximumIterations = 100000;  // of MPRGP, in all
constexpr int kMaximumTightenings = 8;
constexpr double kTightening = 0.1;
constexpr double kResponseTolerance = 1e-5;  // of the bodies' response, which steers the friction problem
constexpr double kSmallTolerance = 1e-11;
constexpr double kLawTolerance = 1e-9;    // of Coulomb's law on the bodies' response
constexpr int kMaximumSweeps = 20000;     // of the friction problem on the bodies' response
constexpr int kMaximumAlternations = 60;  // of staggered projections
constexpr int kMaximumCorrections = 30;   // of the friction problem
constexpr double kLawFactor =
    10.0;  // staggered projections end when impulses change by less than this times the tolerance

// Of all impulses lambda >= 0 that do the same to the bodies, those of least norm, as the other solvers choose them:
// how redundant contacts share a load decides how much friction each can bear.
Eigen::VectorXd leastNorm(const ContactRows& contacts, const Eigen::MatrixXd& inverse_inertia,
                          const Eigen::VectorXd& lambda) {
  const Eigen::MatrixXd Jn = contacts.J.topRows(contacts.count());
  const Eigen::MatrixXd D = Jn * inverse_inertia * Jn.transpose();
  Eigen::MatrixXd regular = D;
  Eigen::VectorXd compliance;
  addCompliance(contacts, regular, compliance);
  Eigen::VectorXd out;
  const LcpReport report = solveLcp(regular, -(D * lambda), out);
  return report.solved ? out : lambda;
}

}  // namespace

struct ReferenceSolver::Impl {
  StepProblem* problem = nullptr;
  std::unique_ptr<StressSystem> system;
  Eigen::IncompleteCholesky<double> cholesky;
  Eigen::MatrixXd inverse_inertia;  // M_S^-1, of the unknowns
  Eigen::MatrixXd response;         // of the free bodies to impulses on them, the liquid implicit; made when needed

  // Unknowns (x, y) with impulses y >= 0 of Jacobian Jc; forces f_v on the bodies, velocities `bias` of the contacts.
  CoupledReport minimise(const StepVector& rhs, const Eigen::VectorXd& body_forces, const Eigen::MatrixXd& Jc,
                         const Eigen::VectorXd& bias, const CoupledOptions& options, Eigen::VectorXd& unknowns,
                         StepVector& x);
  // Solves a problem of the contacts alone: velocities w at the impulses r on entry -> r.
  using SmallProblem = std::function<bool(const Eigen::VectorXd& w, Eigen::VectorXd& r)>;
  // Impulses r of Jacobian Jc by turns: the liquid for given r, then `small` on the bodies' response, until r stays.
  CoupledReport settle(const StepVector& rhs, const Eigen::VectorXd& body_forces, const Eigen::MatrixXd& Jc,
                       const Eigen::VectorXd& bias, const Eigen::VectorXd& compliance, const SmallProblem& small,
                       const CoupledOptions& options, Eigen::VectorXd& unknowns, Eigen::VectorXd& r, StepVector& x);
  // Normal impulses and friction at once, by Coulomb's law on the bodies' response.
  CoupledReport minimiseLaw(const StepVector& rhs, const Eigen::VectorXd& body_forces, const ContactRows& contacts,
                            const CoupledOptions& options, Eigen::VectorXd& unknowns, Eigen::VectorXd& r,
                            StepVector& x);
  // The friction problem: (s, p, f) with the other forces on the bodies given.
  CoupledReport minimiseFriction(const StepVector& rhs, const Eigen::VectorXd& body_forces, const ContactRows& contacts,
                                 const Eigen::VectorXd& radius, const CoupledOptions& options,
                                 Eigen::VectorXd& unknowns, Eigen::VectorXd& f, StepVector& x);
  CoupledReport computeResponse();
  double residual(const StepVector& rhs, const Eigen::VectorXd& contact_forces, const StepVector& x) const;
};

double ReferenceSolver::Impl::residual(const StepVector& rhs, const Eigen::VectorXd& contact_forces,
                                       const StepVector& x) const {
  StepVector r;
  stepResidual(*problem, rhs, x, r);
  problem->coordinates.scatterForces(problem->coordinates.gatherForces(r.bodies) + contact_forces, r.bodies);
  return relativeNorm(*problem, r, rhs);
}

CoupledReport ReferenceSolver::Impl::minimise(const StepVector& rhs, const Eigen::VectorXd& body_forces,
                                              const Eigen::MatrixXd& Jc, const Eigen::VectorXd& bias,
                                              const CoupledOptions& options, Eigen::VectorXd& unknowns, StepVector& x) {
  const StressSystem& s = *system;
  const Eigen::Index n = s.unknowns(), k = Jc.rows();
  const Eigen::VectorXd f = s.faceForces(rhs);
  const Eigen::VectorXd v_free = inverse_inertia * body_forces;
  Eigen::VectorXd b(n + k);
  b.head(n) = s.G * s.inverse_mass.cwiseProduct(f) + s.J * v_free - s.flux(rhs);
  b.tail(k) = -Jc * v_free - bias;
  const Eigen::MatrixXd contact_block = Jc * inverse_inertia * Jc.transpose();
  const Eigen::VectorXd compliance = kContactCompliance * contact_block.diagonal();
  const auto apply = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
    const Eigen::VectorXd v = inverse_inertia * (s.J.transpose() * from.head(n) - Jc.transpose() * from.tail(k));
    to.resize(n + k);
    to.head(n) = s.A * from.head(n) + s.J * v;
    to.tail(k) = -Jc * v + compliance.cwiseProduct(from.tail(k));
  };
  const auto precondition = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
    if (from.size() > 0) to = cholesky.solve(from);
  };
  const double norm = k > 0 ? contact_block.trace() : 1.0;
  CoupledReport report;
  report.solves = 1;
  MprgpOptions mprgp;
  mprgp.tolerance = options.tolerance;
  for (int it = 0; it < kMaximumTightenings; ++it, mprgp.tolerance *= kTightening) {
    mprgp.maximum_iterations = kMaximumIterations - report.iterations;
    const MprgpReport done = solveMprgp(apply, precondition, norm, b, n, mprgp, unknowns);
    report.iterations += done.iterations;
    const Eigen::VectorXd contact_forces = Jc.transpose() * unknowns.tail(k);
    const Eigen::VectorXd v = inverse_inertia * (body_forces - s.J.transpose() * unknowns.head(n) + contact_forces);
    problem->coordinates.scatterMotion(v, x.bodies);
    s.velocityAndPressure(unknowns.head(n), f, x);
    StepVector forced = rhs;
    problem->coordinates.scatterForces(body_forces, forced.bodies);
    report.residual = residual(forced, contact_forces, x);
    if (done.converged && report.residual <= options.tolerance) {
      report.status = SolveStatus::kConverged;
      return report;
    }
    if (report.iterations >= kMaximumIterations) break;
  }
  std::ostringstream text;
  text << "MPRGP stopped at a relative residual of " << report.residual << " after " << report.iterations
       << " iterations; wanted " << options.tolerance;
  report.message = text.str();
  report.status = SolveStatus::kNotConverged;
  return report;
}

CoupledReport ReferenceSolver::Impl::computeResponse() {
  CoupledReport report;
  report.status = SolveStatus::kConverged;
  const Eigen::Index n = problem->bodyUnknowns();
  if (response.size() > 0 || n == 0) return report;
  Eigen::MatrixXd K(n, n);
  StepVector rhs, x;
  rhs.resize(problem->grid.lattice, problem->bodies->size());
  rhs.setZero();
  x = rhs;
  CoupledOptions options;
  options.tolerance = kResponseTolerance;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd impulse = Eigen::VectorXd::Unit(n, i);
    problem->coordinates.scatterForces(impulse, rhs.bodies);
    Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(system->unknowns());
    const CoupledReport column =
        minimise(rhs, impulse, Eigen::MatrixXd(0, n), Eigen::VectorXd(0), options, unknowns, x);
    report.iterations += column.iterations;
    ++report.solves;
    if (column.status != SolveStatus::kConverged) {
      report.status = column.status;
      report.message = column.message;
      return report;
    }
    K.col(i) = problem->coordinates.gatherMotion(x.bodies);
  }
  response = 0.5 * (K + K.transpose());
  return report;
}

CoupledReport ReferenceSolver::Impl::settle(const StepVector& rhs, const Eigen::VectorXd& body_forces,
                                            const Eigen::MatrixXd& Jc, const Eigen::VectorXd& bias,
                                            const Eigen::VectorXd& compliance, const SmallProblem& small,
                                            const CoupledOptions& options, Eigen::VectorXd& unknowns,
                                            Eigen::VectorXd& r, StepVector& x) {
  CoupledReport report;
  const Eigen::MatrixXd none(0, problem->bodyUnknowns());
  for (int it = 0; it < kMaximumCorrections; ++it) {
    const CoupledReport part =
        minimise(rhs, body_forces + Jc.transpose() * r, none, Eigen::VectorXd(0), options, unknowns, x);
    report.iterations += part.iterations;
    report.solves += part.solves;
    report.residual = part.residual;
    report.status = part.status;
    report.message = part.message;
    if (part.status != SolveStatus::kConverged) return report;
    const Eigen::VectorXd w = Jc * problem->coordinates.gatherMotion(x.bodies) + bias + compliance.cwiseProduct(r);
    Eigen::VectorXd next = r;
    const bool solved = small(w, next);
    // Of redundant contacts only what they do to the bodies is determined.
    const double change = (Jc.transpose() * (next - r)).norm();
    const double push = (Jc.transpose() * next).norm();
    r = next;
    if (solved && change <= kLawFactor * options.tolerance * std::max(push, 1e-300)) return report;
  }
  report.status = SolveStatus::kNotConverged;
  report.message = "contact and liquid did not agree in " + std::to_string(kMaximumCorrections) + " solves";
  return report;
}

CoupledReport ReferenceSolver::Impl::minimiseFriction(const StepVector& rhs, const Eigen::VectorXd& body_forces,
                                                      const ContactRows& contacts, const Eigen::VectorXd& radius,
                                                      const CoupledOptions& options, Eigen::VectorXd& unknowns,
                                                      Eigen::VectorXd& f, StepVector& x) {
  const Eigen::Index m = contacts.count();
  Eigen::VectorXd compliance;
  const Eigen::MatrixXd D = contactResponse(contacts, response, compliance).bottomRightCorner(2 * m, 2 * m);
  const DiscQp qp(D);
  const auto small = [&](const Eigen::VectorXd& w, Eigen::VectorXd& next) {
    return qp.solve(w - D * next, radius, kSmallTolerance, kMaximumSweeps, next).solved;
  };
  return settle(rhs, body_forces, contacts.J.bottomRows(2 * m), contacts.bias.tail(2 * m), compliance.tail(2 * m),
                small, options, unknowns, f, x);
}

CoupledReport ReferenceSolver::Impl::minimiseLaw(const StepVector& rhs, const Eigen::VectorXd& body_forces,
                                                 const ContactRows& contacts, const CoupledOptions& options,
                                                 Eigen::VectorXd& unknowns, Eigen::VectorXd& r, StepVector& x) {
  Eigen::VectorXd compliance;
  const Eigen::MatrixXd D = contactResponse(contacts, response, compliance);
  const auto small = [&](const Eigen::VectorXd& w, Eigen::VectorXd& next) {
    return solveFrictionalContact({D, w - D * next, contacts.friction}, kLawTolerance, next).solved;
  };
  return settle(rhs, body_forces, contacts.J, contacts.bias, compliance, small, options, unknowns, r, x);
}

ReferenceSolver::ReferenceSolver() : impl_(std::make_unique<Impl>()) {}
ReferenceSolver::~ReferenceSolver() = default;

void ReferenceSolver::prepare(StepProblem& problem) {
  impl_->problem = &problem;
  impl_->system = std::make_unique<StressSystem>(problem);
  if (impl_->system->unknowns() > 0) impl_->cholesky.compute(impl_->system->A);
  impl_->response.resize(0, 0);
  impl_->inverse_inertia = problem.bodyInertia().inverse();
}

CoupledReport ReferenceSolver::solve(StepVector& rhs, const CoupledOptions& options, StepVector& x) {
  ContactRows none;
  none.J.resize(0, impl_->problem->bodyUnknowns());
  Eigen::VectorXd r;
  return solveWithContacts(rhs, none, options, x, r);
}

CoupledReport ReferenceSolver::solveWithContacts(StepVector& rhs, const ContactRows& contacts,
                                                 const CoupledOptions& options, StepVector& x, Eigen::VectorXd& r) {
  Impl& p = *impl_;
  const StressSystem& s = *p.system;
  const Eigen::Index n = s.unknowns(), m = contacts.count();
  if (r.size() != 3 * m) r = Eigen::VectorXd::Zero(3 * m);
  const Eigen::MatrixXd Jn = contacts.J.topRows(m), Jt = contacts.J.bottomRows(2 * m);
  const Eigen::VectorXd forces = p.problem->coordinates.gatherForces(rhs.bodies);
  const bool frictional = m > 0 && contacts.friction.maxCoeff() > 0.0;
  if (!frictional) r.tail(2 * m).setZero();
  const Eigen::VectorXd start = s.unknownsOf(x, p.problem->coordinates.gatherMotion(x.bodies));

  CoupledReport report;
  if (frictional) {
    report = p.computeResponse();
    if (report.status != SolveStatus::kConverged) return report;
  }
  const auto add = [&report](const CoupledReport& part) {
    report.iterations += part.iterations;
    report.solves += part.solves;
    report.residual = part.residual;
    report.status = part.status;
    report.message = part.message;
  };
  Eigen::VectorXd unknowns(n + m);
  unknowns << start, r.head(m);
  for (int round = 0; round < kMaximumAlternations; ++round) {
    const Eigen::VectorXd before = r;
    add(p.minimise(rhs, forces + Jt.transpose() * r.tail(2 * m), Jn, contacts.bias.head(m), options, unknowns, x));
    if (report.status != SolveStatus::kConverged) return report;
    r.head(m) = leastNorm(contacts, p.inverse_inertia, unknowns.tail(m));
    if (!frictional) return report;
    ++report.friction_iterations;
    // It goes on from the stresses and pressures just found.
    Eigen::VectorXd liquid = unknowns.head(n), f = r.tail(2 * m);
    add(p.minimiseFriction(rhs, forces + Jn.transpose() * r.head(m), contacts,
                           contacts.friction.cwiseProduct(r.head(m)), options, liquid, f, x));
    if (report.status != SolveStatus::kConverged) return report;
    unknowns.head(n) = liquid;
    r.tail(2 * m) = f;
    const Eigen::VectorXd push = contacts.J.transpose() * r;
    const double change = (push - contacts.J.transpose() * before).norm();
    if (change <= kLawFactor * options.tolerance * std::max(push.norm(), 1e-300)) return report;
  }
  Eigen::VectorXd liquid = unknowns.head(n);
  add(p.minimiseLaw(rhs, forces, contacts, options, liquid, r, x));
  return report;
}

}  // namespace monolith
