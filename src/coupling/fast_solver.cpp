#include "coupling/fast_solver.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "coupling/contact_states.h"
#include "coupling/packed_system.h"
#include "solve/staggered_projections.h"

namespace monolith {
namespace {

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
// A round that is not expected to be the last need only reduce its residual to this part: what the contacts do next
// would undo the rest.
constexpr double kRoughPart = 0.03;
// Nor need Coulomb's law be solved for more closely after it, or before the first.
constexpr double kRoughSmallTolerance = 1e-4;
// Rounds after which the response of the bodies in contact is no longer estimated but solved for, and how closely.
constexpr int kRoundsOnEstimate = 10;
constexpr double kResponseTolerance = 1e-6;
constexpr double kTightening = 0.3;  // of the tolerance in each of those rounds
constexpr double kRoundOff = 1e-13;
constexpr double kLeastCurvature = 1e-8;
// Impulses of contacts that press are solved for next to those of the small system: moving away from them costs this
// part of the contact's response. Without it what redundant contacts do one by one is as sensitive as
// kContactCompliance is small.
constexpr double kProximity = 1e-4 / kContactCompliance;  // times its compliance

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
  PackedSystem system;
  std::vector<double> rhs, x, guess;  // kept for their memory
  Eigen::VectorXd compliance;  // of each contact row
  double first_change = 0.0;   // of the contacts after the last step's first round, relative; 0 if that was enough

  void setBorder(const ContactBorder& border) { system.setBorder(border, compliance, kProximity); }

  // Response of the twists of the bodies in contact to unit impulses, by one liquid solve each; false if one fails.
  bool solveResponse(const ContactRows& contacts, const CoupledOptions& options, CoupledReport& report,
                     Eigen::MatrixXd& K) {
    setBorder(makeBorder(contacts, openStates(contacts)));
    const Eigen::Index n = system.bodySize();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (contacts.J.col(i).isZero(0.0)) continue;
      std::vector<double> push(system.size(), 0.0), answer(push);
      system.setForces(Eigen::VectorXd::Unit(n, i), push);
      const double goal = std::max(options.tolerance, kResponseTolerance) * push[system.liquidSize() + i];
      if (!system.solve(push, answer, goal, 0.0, options, report).converged) return false;
      K.col(i) = system.twists(answer);
    }
    K = 0.5 * (K + K.transpose()).eval();
    return true;
  }

  CoupledReport notConverged(CoupledReport report, const std::string& message) {
    system.distrust();
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
  m.system.set(problem);
}

CoupledReport FastSolver::solve(const StepVector& rhs, const CoupledOptions& options, StepVector& x) {
  Eigen::VectorXd none;
  ContactRows no_contacts;
  no_contacts.J.resize(0, impl_->system.bodySize());
  return solveWithContacts(rhs, no_contacts, options, x, none);
}

CoupledReport FastSolver::solveWithContacts(const StepVector& rhs_fields, const ContactRows& contacts,
                                            const CoupledOptions& options, StepVector& x_fields, Eigen::VectorXd& r) {
  Impl& m = *impl_;
  StepProblem& p = *m.problem;
  CoupledReport report;
  PackedSystem& system = m.system;
  system.updateSchur();
  const std::size_t tail = system.size();
  std::vector<double>&rhs = m.rhs, &x = m.x;
  system.packForces(rhs_fields, rhs);
  system.packMotion(x_fields, x);
  const double rhs_norm = stepNorm(p, rhs_fields);
  const Eigen::Index count = contacts.count();
  const double small_tolerance = std::max(kSmallFactor * options.tolerance, kSmallTolerance);

  // Response of bodies and contacts on the approximate Schur complement.
  Eigen::MatrixXd K, D;
  Eigen::VectorXd last_push, last_twists;
  ContactStates states;
  const ContactStates open = openStates(contacts);
  const auto velocities = [&](const Eigen::VectorXd& twists) {
    return Eigen::VectorXd(contacts.J * twists + contacts.bias);
  };
  if (count > 0) {
    K = system.estimatedResponse();
    D = contactResponse(contacts, K, m.compliance);
    // One cycle on the whole residual says roughly how the bodies would move without contact.
    m.setBorder(makeBorder(contacts, open));
    if (r.size() != 3 * count) r = Eigen::VectorXd::Zero(3 * count);
    const Eigen::VectorXd w0 = velocities(system.improvedTwists(rhs, x));
    const FrictionReport friction = solveFrictionalContact(D, w0, contacts.friction, std::max(small_tolerance, kRoughSmallTolerance), r);
    report.friction_iterations += friction.iterations;
    states = contactStates(contacts, D, D * r + w0, r);
  }

  bool lawful = false;
  bool from_open = count == 0;
  double expected = m.first_change;  // change of the contacts that this round will ask for
  if (count > 0) m.guess = x;
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
    const Eigen::VectorXd start = borderUnknowns(contacts, states, border, r);
    rhs.resize(tail + border.count());
    if (given) {
      system.setForces(gatherBodies(p, rhs_fields.bodies) + contacts.J.transpose() * r, rhs);
    }
    x.resize(tail + border.count());
    for (Eigen::Index i = 0; i < border.count(); ++i) {
      rhs[tail + i] = border.bias[i] - kProximity * m.compliance[border.entry[i]] * start[i];
      x[tail + i] = start[i];
    }
    // Given impulses are judged by the velocities that come of them, which the solve's error must not drown.
    const double closer = given ? std::pow(kTightening, round - kRoundsOnEstimate + 1) : 1.0;
    const bool rough = count > 0 && !given && expected > kLawFactor * options.tolerance;
    last = system.solve(rhs, x, std::max(closer * options.tolerance, kRoundOff) * rhs_norm, rough ? kRoughPart : 0.0,
                        options, report);
    if (!last.converged) {
      // The first guess of what the contacts do may be far off, and then hard to solve for: begin with none that press.
      if (from_open || border.count() == 0) break;
      from_open = true;
      x = m.guess;
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
    const Eigen::VectorXd push = contacts.J.transpose() * r;
    const Eigen::VectorXd twists = system.twists(x);
    const Eigen::VectorXd w = velocities(twists);
    // Below a certain change the solve's own error is all that there is to see.
    const double error = std::max(options.tolerance, last.residual / rhs_norm);
    const double seen = last_push.size() > 0 ? (contacts.J * (twists - last_twists)).cwiseAbs().maxCoeff() : 0.0;
    const double speed = (w - contacts.bias).cwiseAbs().maxCoeff();
    if (!given && seen > kLearnable * error * speed) {
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
    const double closely = rough ? std::max(small_tolerance, kRoughSmallTolerance) : small_tolerance;
    const FrictionReport friction = solveFrictionalContact(D, w0, contacts.friction, closely, next);
    report.friction_iterations += friction.iterations;
    const double change = (D * (next - r)).cwiseAbs().maxCoeff();
    const double scale = std::max((D * next).cwiseAbs().maxCoeff(), speed);
    // No closer than the small system is solved.
    const double small_residual = std::max(closely, friction.residual);
    const double least = kSmallFloor * small_residual * w0.cwiseAbs().maxCoeff() + kLeastSpeed;
    const bool settled = (friction.solved || friction.residual <= kAcceptableLaw) &&
                         change <= std::max(kLawFactor * options.tolerance * scale, least);
    lawful = settled && !rough;
    const double relative = scale > 0.0 ? change / scale : 0.0;
    expected = settled ? 0.0 : relative * relative;
    if (round == 0) m.first_change = settled ? 0.0 : relative;
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
  system.judgeAge();
  const std::vector<Vector6d> others = x_fields.bodies;
  system.unpackMotion(x, x_fields);
  for (std::size_t b = 0; b < others.size(); ++b) {
    if (p.free_index[b] < 0) x_fields.bodies[b] = others[b];
  }
  report.status = CoupledReport::Status::kConverged;
  return report;
}

}  // namespace monolith
