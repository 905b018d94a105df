#include "coupling/fast_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "coupling/contact_guess.h"
#include "coupling/packed_system.h"

namespace monolith {
namespace {

// A round that is not expected to be the last need only reduce its residual to this part: what the contacts do next
// would undo the rest.
constexpr double kRoughPart = 0.03;
// Rounds after which the response of the bodies in contact is no longer estimated but solved for, and how closely.
constexpr int kRoundsOnEstimate = 10;
constexpr double kResponseTolerance = 1e-6;
// Without liquid the response is exact from the start, and one round is as good as any.
constexpr int kDryRounds = 2;
constexpr double kTightening = 0.3;  // of the tolerance in each of those rounds
// In others the contacts may come no closer to settling by this part: what they see then is the solve's error, which
// is to be smaller, as much as they are too far.
constexpr double kNoCloser = 0.5;
constexpr double kMostTightening = 0.03;
// A guess is the solution if it is closer than the tolerance by this part. It is the motion of the step before: what it
// leaves wrong would be left again and again, and forces below the tolerance would never move a body, nor would they be
// told of: one iteration lets them.
constexpr double kGuessTolerance = 1e-5;
constexpr double kRoundOff = 1e-13;
// Impulses of contacts that press are solved for next to those of the small system: moving away from them costs this
// part of the contact's response. Without it what redundant contacts do one by one is as sensitive as
// kContactCompliance is small.
constexpr double kProximity = 1e-4 / kContactCompliance;  // times its compliance, were it as hard as others

Eigen::VectorXd proximity(const ContactRows& contacts, const Eigen::VectorXd& compliance) {
  return kProximity * compliance.cwiseQuotient(contacts.softness);
}

}  // namespace

struct FastSolver::Impl {
  StepProblem* problem = nullptr;
  PackedSystem system;
  double first_change = 0.0;  // of the contacts after the last step's first round, relative; 0 if that was enough

  // Response of the twists of the bodies in contact to unit impulses, by one liquid solve each; false if one fails.
  bool solveResponse(const ContactRows& contacts, const CoupledOptions& options, CoupledReport& report,
                     Eigen::MatrixXd& K) {
    system.setBorder(makeBorder(contacts, openStates(contacts)), Eigen::VectorXd());
    const Eigen::Index n = system.bodySize();
    K = system.estimatedResponse();
    StepVector push_fields, answer_fields;
    for (StepVector* v : {&push_fields, &answer_fields}) v->resize(system.lattice(), problem->bodies->size());
    for (Eigen::Index i = 0; i < n; ++i) {
      if (contacts.J.col(i).isZero(0.0)) continue;
      answer_fields.setZero();
      BorderedVector push = system.forces(push_fields), answer = system.motion(answer_fields);
      system.setForces(Eigen::VectorXd::Unit(n, i), push);
      const double goal = std::max(options.tolerance, kResponseTolerance) * push.rest[i];
      if (!system.solve(push, answer, {goal}, options, report).converged) return false;
      K.col(i) = system.motionOf(answer);
    }
    K = 0.5 * (K + K.transpose()).eval();
    system.adoptResponse(K);
    return true;
  }

  // Rows of the border behind the right side and the guess, which start from the impulses r.
  void appendBorder(const ContactRows& contacts, const ContactStates& states, const Eigen::VectorXd& compliance,
                    const Eigen::VectorXd& r, ContactBorder& border, BorderedVector& rhs, BorderedVector& x) {
    border = makeBorder(contacts, states);
    const Eigen::VectorXd held = proximity(contacts, compliance);
    system.setBorder(border, compliance + held);
    const Eigen::VectorXd start = borderUnknowns(contacts, states, border, r);
    const Eigen::Index bodies = system.bodySize();
    rhs.rest.resize(bodies + border.count());
    x.rest.resize(bodies + border.count());
    for (Eigen::Index i = 0; i < border.count(); ++i) {
      rhs.rest[bodies + i] = border.bias[i] - held[border.entry[i]] * start[i];
      x.rest[bodies + i] = start[i];
    }
  }

  CoupledReport notConverged(CoupledReport report, const std::string& message) {
    system.distrust();
    report.status = SolveStatus::kNotConverged;
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

CoupledReport FastSolver::solve(StepVector& rhs, const CoupledOptions& options, StepVector& x) {
  Eigen::VectorXd none;
  ContactRows no_contacts;
  no_contacts.J.resize(0, impl_->system.bodySize());
  return solveWithContacts(rhs, no_contacts, options, x, none);
}

CoupledReport FastSolver::solveWithContacts(StepVector& rhs_fields, const ContactRows& contacts,
                                            const CoupledOptions& options, StepVector& x_fields, Eigen::VectorXd& r) {
  Impl& m = *impl_;
  StepProblem& p = *m.problem;
  CoupledReport report;
  PackedSystem& system = m.system;
  system.updateSchur();
  BorderedVector rhs = system.forces(rhs_fields), x = system.motion(x_fields);
  double rhs_norm =
      std::hypot(rhs.velocity_norm, rhs.pressure_norm, bodiesNorm(p, p.coordinates.gatherForces(rhs_fields.bodies)));
  if (!std::isfinite(rhs_norm)) return m.notConverged(report, "what acts on liquid and bodies is too large a number");
  const Eigen::Index count = contacts.count();

  // Without liquid at any body S is their inertia, and exact.
  const bool wet = std::find(p.touched.begin(), p.touched.end(), 1) != p.touched.end();
  const int on_estimate = wet ? kRoundsOnEstimate : 0;
  system.moveUntouched(rhs, contacts, x);
  ContactGuess guess(contacts, r, options.tolerance);
  if (count > 0) {
    guess.setResponse(system.estimatedResponse());
    // One cycle on the whole residual says roughly how the bodies would move without contact.
    system.setBorder(makeBorder(contacts, openStates(contacts)), Eigen::VectorXd());
    guess.startFrom(wet ? system.improvedMotion(rhs, x) : system.moveDry(rhs, x), wet, report);
    // What presses the contacts may be all that there is.
    rhs_norm = std::max(rhs_norm, bodiesNorm(p, guess.push()));
  }

  bool lawful = false;
  bool from_open = count == 0;
  double expected = m.first_change;  // change of the contacts that this round will ask for, relative
  double asked = std::numeric_limits<double>::infinity();  // by the round before
  double closer = 1.0;
  KrylovReport last;
  KrylovPast past = count > 0 && wet ? KrylovPast::kDirection : KrylovPast::kNothing;
  const int rounds = wet || count == 0 ? options.maximum_rounds : std::min(kDryRounds, options.maximum_rounds);
  for (int round = 0; round < rounds && !lawful; ++round) {
    // On the exact response the impulses are right but for the shift and are given; what redundant contacts do one by
    // one is too sensitive to be solved for over and over.
    const bool given = count > 0 && round >= on_estimate;
    if (given && wet && round == on_estimate) {
      Eigen::MatrixXd K;
      if (!m.solveResponse(contacts, options, report, K)) break;
      past = KrylovPast::kNothing;
      guess.setResponse(K);
    }
    const ContactStates states = given ? openStates(contacts) : guess.states();
    ContactBorder border;
    m.appendBorder(contacts, states, guess.compliance(), r, border, rhs, x);
    if (given) system.setForces(p.coordinates.gatherForces(rhs_fields.bodies) + guess.push(), rhs);
    if (given && !wet) system.moveDry(rhs, x);
    // Given impulses are judged by the velocities that come of them, which the solve's error must not drown.
    if (given) closer = std::pow(kTightening, round - on_estimate + 1);
    const bool rough = count > 0 && !given && expected > ContactGuess::settledAt(options.tolerance);
    PackedSystem::Goal goal{std::max(closer * options.tolerance, kRoundOff) * rhs_norm, rough ? kRoughPart : 0.0};
    if (round == 0) goal.of_guess = std::max(kGuessTolerance * options.tolerance, kRoundOff) * rhs_norm;
    last = system.solve(rhs, x, goal, options, report, past);
    past = KrylovPast::kResidual;
    if (!last.converged) {
      // The first guess of what the contacts do may be far off, and then hard to solve for: begin with none that press.
      if (from_open || border.count() == 0) break;
      from_open = true;
      x = system.motion(x_fields);
      system.moveUntouched(rhs, contacts, x);
      for (double* field : x.fields()) std::fill_n(field, system.lattice().size, 0.0);
      past = KrylovPast::kNothing;
      guess.setOpen();
      continue;
    }
    if (count == 0) {
      lawful = true;
      break;
    }
    const Eigen::VectorXd motion = system.motionOf(x);
    if (!given) {
      const auto y = Eigen::Map<const Eigen::VectorXd>(x.rest.data() + system.bodySize(), border.count());
      guess.setImpulses(impulses(contacts, states, border, y));
      guess.learnFrom(motion, std::max(options.tolerance, last.residual / rhs_norm));
    }
    const ContactGuess::Change change = guess.proceedFrom(motion, rough, report);
    lawful = change.settled && !rough;
    // The border is Newton's method.
    expected = change.settled ? 0.0 : change.relative * change.relative;
    if (round == 0) m.first_change = change.settled ? 0.0 : change.relative;
    if ((!rough || last.iterations == 0) && change.relative > kNoCloser * asked) {
      const double far = change.relative / ContactGuess::settledAt(options.tolerance);
      closer = std::min(closer, last.residual / (options.tolerance * rhs_norm)) *
               std::clamp(kNoCloser / far, kMostTightening, kTightening);
    }
    asked = change.relative;
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
  system.finish(x, x_fields);
  report.status = SolveStatus::kConverged;
  return report;
}

}  // namespace monolith
