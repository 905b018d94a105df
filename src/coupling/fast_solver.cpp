#include "coupling/fast_solver.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "coupling/body_schur.h"
#include "coupling/contact_states.h"
#include "coupling/liquid_preconditioner.h"
#include "solve/fgmres.h"
#include "solve/staggered_projections.h"

namespace monolith {
namespace {

// The bodies' resistance is estimated anew when the solve takes this many times the iterations that it took when
// fresh...
constexpr double kStaleIterations = 1.4;
// ... or the viscous number has changed by this factor.
constexpr double kStaleNumber = 1.5;
// Coulomb's law on the small system is solved this much more closely than the whole, as far as digits allow.
constexpr double kSmallFactor = 0.01;
constexpr double kSmallTolerance = 1e-9;
// Contacts have settled when what they do to the bodies' velocities changes by less than the solve's tolerance times
// this, relative to the speeds at the contacts.
constexpr double kLawFactor = 10.0;
// The response is learnt from changes of speed larger than this times the tolerance.
constexpr double kLearnable = 1000.0;
constexpr double kSmallFloor = 3.0;
// Many redundant contacts near the limit of their friction (an arch about to fall) may leave the law short of its
// tolerance: so much of the contacts' speeds is accepted, and reported.
constexpr double kAcceptableLaw = 1e-3;
constexpr double kLeastSpeed = 1e-10;  // m/s
// Rounds after which the response of the bodies in contact is no longer estimated but solved for, and how closely.
constexpr int kRoundsOnEstimate = 10;
constexpr double kResponseTolerance = 1e-6;
constexpr double kTightening = 0.3;  // of the tolerance in each of those rounds
constexpr double kRoundOff = 1e-13;
constexpr double kLeastCurvature = 1e-8;
// Impulses of contacts that press are solved for next to those of the small system: moving away from them costs this
// part of the contact's response. Without it what redundant contacts do one by one is as sensitive as
// kContactCompliance is small.
constexpr double kProximity = 1e-4;

// Symmetric rank-one update of the response K so that it gives the change of twists dv that impulses dg were seen to
// make; left alone where that would cost its definiteness.
void learnResponse(const Eigen::VectorXd& dg, const Eigen::VectorXd& dv, Eigen::MatrixXd& K) {
  const Eigen::VectorXd miss = dv - K * dg;
  const double curvature = miss.dot(dg);
  if (!(std::abs(curvature) > kLeastCurvature * miss.norm() * dg.norm())) return;
  const Eigen::MatrixXd next = K + miss * miss.transpose() / curvature;
  if (curvature > 0.0 || Eigen::LLT<Eigen::MatrixXd>(next).info() == Eigen::Success) K = next;
}

}  // namespace

struct FastSolver::Impl {
  StepProblem* problem = nullptr;
  LiquidPreconditioner preconditioner;
  StepOperator op;
  Fgmres krylov;
  Eigen::MatrixXd resistance;  // of the free bodies, see BodySchur
  std::vector<int> resistance_of;
  double resistance_number = -1.0;
  int fresh_iterations = 0;
  bool stale = true;
  StepVector in, out;
  Eigen::VectorXd scale;                       // Krylov unknown = scale * twist
  Eigen::MatrixXd S;                           // inertia plus resistance, in Krylov units
  ContactBorder border;                        // in Krylov units
  Eigen::VectorXd compliance;                  // of each contact row
  Eigen::VectorXd border_compliance;           // of those in the border
  Eigen::PartialPivLU<Eigen::MatrixXd> small;  // S bordered by the contacts

  const Lattice& lattice() const { return problem->grid.lattice; }
  std::size_t liquidSize() const { return 4 * lattice().size; }
  Eigen::Index bodySize() const { return problem->bodyUnknowns(); }

  void updateSchur() {
    StepProblem& p = *problem;
    const bool same = resistance_of == p.free && resistance_number >= 0.0 &&
                      p.viscous_number <= kStaleNumber * resistance_number &&
                      resistance_number <= kStaleNumber * p.viscous_number && !stale;
    if (!same) {
      resistance = BodySchur::resistance(op, preconditioner, lattice(), p.bodies->size(), p.free);
      resistance_of = p.free;
      resistance_number = p.viscous_number;
      fresh_iterations = 0;
      stale = false;
    }
    scale.resize(bodySize());
    S = resistance;
    for (std::size_t i = 0; i < p.free.size(); ++i) {
      S.block<6, 6>(6 * i, 6 * i) += p.inertia[i];
      scale.segment<6>(6 * i) = p.twist_scale[i];
    }
    const Eigen::VectorXd inverse = scale.cwiseInverse();
    S = (inverse.asDiagonal() * S * inverse.asDiagonal()).eval();
  }

  // Krylov vector <-> fields. Tail: bodies, then contacts.
  void unpack(const std::vector<double>& x, StepVector& v) const {
    const std::size_t size = lattice().size;
    for (int a = 0; a < 3; ++a) std::copy_n(x.begin() + a * size, size, v.velocity[a].begin());
    std::copy_n(x.begin() + 3 * size, size, v.pressure.begin());
    for (auto& twist : v.bodies) twist.setZero();
    const Eigen::Map<const Eigen::VectorXd> tail(x.data() + liquidSize(), bodySize());
    scatterBodies(*problem, tail.cwiseQuotient(scale), v.bodies);
  }
  void pack(const StepVector& v, std::vector<double>& x, bool forces) const {
    const std::size_t size = lattice().size;
    for (int a = 0; a < 3; ++a) std::copy_n(v.velocity[a].begin(), size, x.begin() + a * size);
    std::copy_n(v.pressure.begin(), size, x.begin() + 3 * size);
    Eigen::Map<Eigen::VectorXd> tail(x.data() + liquidSize(), bodySize());
    const Eigen::VectorXd b = gatherBodies(*problem, v.bodies);
    if (forces) {
      tail = b.cwiseQuotient(scale);
    } else {
      tail = b.cwiseProduct(scale);
    }
  }

  void setBorder(const ContactBorder& physical) {
    border = physical;
    border.R = physical.R * scale.cwiseInverse().asDiagonal();
    border.C = scale.cwiseInverse().asDiagonal() * physical.C;
    const Eigen::Index n = bodySize(), k = border.count();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + k, n + k);
    M.topLeftCorner(n, n) = S;
    M.bottomLeftCorner(k, n) = -border.R;
    M.topRightCorner(n, k) = -border.C;
    border_compliance.resize(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      const double least = compliance[border.entry[i]];
      border_compliance[i] = least * (1.0 + kProximity / kContactCompliance);
    }
    M.bottomRightCorner(k, k).diagonal() = -border_compliance;
    if (M.size() > 0) small.compute(M);
  }

  void apply(const std::vector<double>& from, std::vector<double>& to) {
    to.resize(from.size());
    unpack(from, in);
    problem->apply(in, out);
    pack(out, to, true);
    const Eigen::Index n = bodySize(), k = border.count();
    if (k == 0) return;
    const Eigen::Map<const Eigen::VectorXd> v(from.data() + liquidSize(), n);
    const Eigen::Map<const Eigen::VectorXd> y(from.data() + liquidSize() + n, k);
    Eigen::Map<Eigen::VectorXd>(to.data() + liquidSize(), n) -= border.C * y;
    Eigen::Map<Eigen::VectorXd>(to.data() + liquidSize() + n, k) = -border.R * v - border_compliance.cwiseProduct(y);
  }

  void precondition(const std::vector<double>& from, std::vector<double>& to) {
    to.resize(from.size());
    unpack(from, in);
    preconditioner.apply(in, out);
    // Bodies feel what the liquid has just been given.
    op.bodyForces(out, in.bodies);
    for (auto& field : out.velocity) clearHalo(lattice(), field);
    clearHalo(lattice(), out.pressure);
    pack(out, to, false);
    const Eigen::Index n = bodySize() + border.count();
    if (n == 0) return;
    Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(from.data() + liquidSize(), n);
    r.head(bodySize()) -= gatherBodies(*problem, in.bodies).cwiseQuotient(scale);
    Eigen::Map<Eigen::VectorXd>(to.data() + liquidSize(), n) = small.solve(r);
  }

  KrylovReport linearSolve(std::vector<double>& rhs, std::vector<double>& x, double goal, const CoupledOptions& options,
                           CoupledReport& report) {
    KrylovOptions k;
    k.absolute_tolerance = goal;
    k.maximum_iterations = options.maximum_iterations;
    const KrylovReport done = krylov.solve([this](const auto& from, auto& to) { apply(from, to); },
                                           [this](const auto& from, auto& to) { precondition(from, to); }, rhs, x, k);
    report.iterations += done.iterations;
    ++report.solves;
    return done;
  }

  // Response of the twists of the bodies in contact to unit impulses, by one liquid solve each; false if one fails.
  bool solveResponse(const ContactRows& contacts, const CoupledOptions& options, CoupledReport& report,
                     Eigen::MatrixXd& K) {
    setBorder(makeBorder(contacts, openStates(contacts)));
    const std::size_t liquid = liquidSize();
    for (Eigen::Index i = 0; i < bodySize(); ++i) {
      if (contacts.J.col(i).isZero(0.0)) continue;
      std::vector<double> rhs(liquid + bodySize(), 0.0), x(rhs);
      rhs[liquid + i] = 1.0 / scale[i];
      const double goal = std::max(options.tolerance, kResponseTolerance) / scale[i];
      if (!linearSolve(rhs, x, goal, options, report).converged) return false;
      K.col(i) = Eigen::Map<const Eigen::VectorXd>(x.data() + liquid, bodySize()).cwiseQuotient(scale);
    }
    K = 0.5 * (K + K.transpose()).eval();
    return true;
  }

  // The estimate of the resistance is old if it takes clearly more iterations than when it was made.
  void judgeAge(const CoupledReport& report) {
    if (report.solves == 0 || bodySize() == 0) return;
    const int iterations = report.iterations / report.solves;
    if (fresh_iterations == 0) fresh_iterations = std::max(iterations, 5);
    stale = iterations > kStaleIterations * fresh_iterations + 1;
  }

  CoupledReport notConverged(CoupledReport report, const std::string& message) {
    stale = true;
    report.status = CoupledReport::Status::kNotConverged;
    report.message = message;
    return report;
  }
};

FastSolver::FastSolver() : impl_(std::make_unique<Impl>()) {}
FastSolver::~FastSolver() = default;

void FastSolver::prepare(StepProblem& problem) {
  Impl& m = *impl_;
  m.problem = &problem;
  m.op.set(&problem.coefficients, &problem.rows);
  std::vector<StaggeredCoefficients<float>> levels = std::move(problem.coarse);
  problem.coarse = m.preconditioner.takeLevels();
  levels[0] = convertCoefficients<float>(problem.coefficients);
  m.preconditioner.set(std::move(levels), problem.viscous_number, &problem.cell_viscosity, &problem.regions);
}

CoupledReport FastSolver::solve(const StepVector& rhs, const CoupledOptions& options, StepVector& x) {
  Eigen::VectorXd none;
  ContactRows no_contacts;
  no_contacts.J.resize(0, impl_->bodySize());
  return solveWithContacts(rhs, no_contacts, options, x, none);
}

CoupledReport FastSolver::solveWithContacts(const StepVector& rhs_fields, const ContactRows& contacts,
                                            const CoupledOptions& options, StepVector& x_fields, Eigen::VectorXd& r) {
  Impl& m = *impl_;
  StepProblem& p = *m.problem;
  CoupledReport report;
  m.in.resize(m.lattice(), p.bodies->size());
  m.out.resize(m.lattice(), p.bodies->size());
  m.updateSchur();
  const std::size_t tail = m.liquidSize() + static_cast<std::size_t>(m.bodySize());
  std::vector<double> rhs(tail), x(tail);
  m.pack(rhs_fields, rhs, true);
  m.pack(x_fields, x, false);
  const double rhs_norm = stepNorm(p, rhs_fields);
  const Eigen::Index count = contacts.count();
  const double small_tolerance = std::max(kSmallFactor * options.tolerance, kSmallTolerance);

  // Response of bodies and contacts on the approximate Schur complement.
  Eigen::MatrixXd K, D;
  Eigen::VectorXd last_push, last_twists;
  ContactStates states;
  const ContactStates open = openStates(contacts);
  const auto velocities = [&](const std::vector<double>& from) {
    const Eigen::Map<const Eigen::VectorXd> v(from.data() + m.liquidSize(), m.bodySize());
    return Eigen::VectorXd(contacts.J * v.cwiseQuotient(m.scale) + contacts.bias);
  };
  if (count > 0) {
    const auto n = m.bodySize();
    const Eigen::VectorXd inverse = m.scale.cwiseInverse();
    K = inverse.asDiagonal() * m.S.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * inverse.asDiagonal();
    D = contactResponse(contacts, K, m.compliance);
    // One cycle on the whole residual says roughly how the bodies would move without contact.
    m.setBorder(makeBorder(contacts, open));
    std::vector<double> residual(tail), z(tail);
    m.apply(x, residual);
    for (std::size_t i = 0; i < tail; ++i) residual[i] = rhs[i] - residual[i];
    m.precondition(residual, z);
    for (std::size_t i = 0; i < tail; ++i) z[i] += x[i];
    if (r.size() != 3 * count) r = Eigen::VectorXd::Zero(3 * count);
    const Eigen::VectorXd w0 = velocities(z);
    const FrictionReport friction = solveFrictionalContact(D, w0, contacts.friction, small_tolerance, r);
    report.friction_iterations += friction.iterations;
    states = contactStates(contacts, D, D * r + w0, r);
  }

  bool lawful = false;
  bool from_open = count == 0;
  const std::vector<double> guess(x);
  KrylovReport last;
  for (int round = 0; round < options.maximum_rounds && !lawful; ++round) {
    if (round == kRoundsOnEstimate) {
      if (!m.solveResponse(contacts, options, report, K)) break;
      D = contactResponse(contacts, K, m.compliance);
    }
    // On the exact response the impulses are right but for the shift and are given; what redundant contacts do one by
    // one is too sensitive to be solved for over and over.
    const bool given = round >= kRoundsOnEstimate;
    const ContactBorder border = makeBorder(contacts, given ? open : states);
    m.setBorder(border);
    const Eigen::VectorXd start = borderUnknowns(border, r);
    rhs.resize(tail + border.count());
    if (given) {
      Eigen::Map<Eigen::VectorXd>(rhs.data() + m.liquidSize(), m.bodySize()) =
          (gatherBodies(p, rhs_fields.bodies) + contacts.J.transpose() * r).cwiseQuotient(m.scale);
    }
    x.resize(tail + border.count());
    for (Eigen::Index i = 0; i < border.count(); ++i) {
      rhs[tail + i] = border.bias[i] - (m.border_compliance[i] - m.compliance[border.entry[i]]) * start[i];
      x[tail + i] = start[i];
    }
    // Given impulses are judged by the velocities that come of them, which the solve's error must not drown.
    const double closer = given ? std::pow(kTightening, round - kRoundsOnEstimate + 1) : 1.0;
    last = m.linearSolve(rhs, x, std::max(closer * options.tolerance, kRoundOff) * rhs_norm, options, report);
    if (!last.converged) {
      // The first guess of what the contacts do may be far off, and then hard to solve for: begin with none that press.
      if (from_open || border.count() == 0) break;
      from_open = true;
      x = guess;
      r.setZero();
      states = open;
      continue;
    }
    if (count == 0) {
      lawful = true;
      break;
    }
    const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(x.data() + tail, border.count());
    if (!given) r = impulses(contacts, states, border, y);
    const Eigen::VectorXd w = velocities(x);
    const Eigen::VectorXd push = contacts.J.transpose() * r;
    const Eigen::VectorXd twists =
        Eigen::Map<const Eigen::VectorXd>(x.data() + m.liquidSize(), m.bodySize()).cwiseQuotient(m.scale);
    // Below a certain change the solve's own error is all that there is to see.
    const double seen = last_push.size() > 0 ? (contacts.J * (twists - last_twists)).cwiseAbs().maxCoeff() : 0.0;
    const double speed = (w - contacts.bias).cwiseAbs().maxCoeff();
    if (!given && seen > kLearnable * options.tolerance * speed) {
      learnResponse(push - last_push, twists - last_twists, K);
      const Eigen::VectorXd compliance = m.compliance;
      D = contactResponse(contacts, K, m.compliance);
      // The border was solved with the compliance it had.
      D.diagonal() += compliance - m.compliance;
      m.compliance = compliance;
    }
    last_push = push;
    last_twists = twists;
    // The small system, shifted so that it reproduces this solution exactly, says what the contacts do next. If that
    // moves no body, its impulses obey Coulomb's law here.
    Eigen::VectorXd next = r;
    const Eigen::VectorXd w0 = w - D * r + m.compliance.cwiseProduct(r);
    const FrictionReport friction = solveFrictionalContact(D, w0, contacts.friction, small_tolerance, next);
    report.friction_iterations += friction.iterations;
    const double change = (D * (next - r)).cwiseAbs().maxCoeff();
    const double scale = std::max((D * next).cwiseAbs().maxCoeff(), speed);
    // No closer than the small system is solved.
    const double small_residual = std::max(small_tolerance, friction.residual);
    const double least = kSmallFloor * small_residual * w0.cwiseAbs().maxCoeff() + kLeastSpeed;
    lawful = (friction.solved || friction.residual <= kAcceptableLaw) &&
             change <= std::max(kLawFactor * options.tolerance * scale, least);
    report.contact_residual = friction.residual;
    r = next;
    states = contactStates(contacts, D, D * next + w0, next);
  }

  report.residual = rhs_norm > 0.0 ? last.residual / rhs_norm : 0.0;
  std::ostringstream text;
  if (!last.converged || !std::isfinite(last.residual)) {
    text << "the coupled solve stopped at a relative residual of " << report.residual << " after " << last.iterations
         << " iterations; wanted " << options.tolerance;
    return m.notConverged(report, text.str());
  }
  if (!lawful) {
    text << "the contacts did not settle in " << report.solves << " solves (" << count << " contacts)";
    return m.notConverged(report, text.str());
  }
  m.judgeAge(report);
  const std::vector<Vector6d> others = x_fields.bodies;
  m.unpack(x, x_fields);
  for (std::size_t b = 0; b < others.size(); ++b) {
    if (p.free_index[b] < 0) x_fields.bodies[b] = others[b];
  }
  report.status = CoupledReport::Status::kConverged;
  return report;
}

}  // namespace monolith
