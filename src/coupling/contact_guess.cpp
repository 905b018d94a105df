#include "coupling/contact_guess.h"

#include <algorithm>
#include <cmath>

#include "solve/frictional_contact.h"

namespace monolith {
namespace {

// Coulomb's law on the small system is solved this much more closely than the whole, as far as digits allow; roughly
// where the next solution will correct it.
constexpr double kSmallFactor = 0.01;
constexpr double kSmallTolerance = 1e-9;
constexpr double kRoughSmallTolerance = 1e-4;
// Contacts have settled when what they do to the bodies' velocities changes by less than the solve's tolerance times
// this, relative to the speeds at the contacts.
constexpr double kLawFactor = 10.0;
// The response is learnt from changes of speed larger than this times the solution's error.
constexpr double kLearnable = 1000.0;
constexpr double kLeastCurvature = 1e-8;
constexpr double kSmallFloor = 3.0;
constexpr double kLeastSpeed = 1e-10;  // m/s

}  // namespace

ContactGuess::ContactGuess(const ContactRows& rows, Eigen::VectorXd& impulses, double tolerance)
    : rows_(rows), r_(impulses), tolerance_(tolerance), states_(openStates(rows)) {
  const Eigen::Index m = rows.count();
  if (r_.size() != 3 * m) r_ = Eigen::VectorXd::Zero(3 * m);
  bodies_.contacts.resize(m);
  for (Eigen::Index c = 0; c < m; ++c) {
    for (Eigen::Index first = 0; first < rows.J.cols(); first += 6) {
      const Eigen::Index width = std::min<Eigen::Index>(6, rows.J.cols() - first);
      BodyResponse::Contact::Rows J(3, width);
      J << rows.J.block(c, first, 1, width), rows.J.block(m + 2 * c, first, 2, width);
      if (!J.isZero(0.0)) bodies_.contacts[c].of.emplace_back(first, J);
    }
  }
}

double ContactGuess::settledAt(double tolerance) { return kLawFactor * tolerance; }

double ContactGuess::closeness(bool rough) const {
  const double least = rough ? kRoughSmallTolerance : kSmallTolerance;
  return std::max(kSmallFactor * tolerance_, least);
}

void ContactGuess::setResponse(const Eigen::MatrixXd& K) {
  bodies_.K = K;
  D_ = contactResponse(rows_, K, bodies_.compliance);
  bodies_.K_inverse.resize(0, 0);
  if (K.rows() >= D_.rows()) return;  // the contacts' own equations are fewer
  const Eigen::LLT<Eigen::MatrixXd> factor(K);
  if (factor.info() != Eigen::Success) return;
  bodies_.K_inverse = factor.solve(Eigen::MatrixXd::Identity(K.rows(), K.cols()));
}

FrictionReport ContactGuess::solveLaw(const Eigen::VectorXd& w0, bool rough, Eigen::VectorXd& r) const {
  const BodyResponse* bodies = bodies_.K_inverse.size() > 0 ? &bodies_ : nullptr;
  return solveFrictionalContact({D_, w0, rows_.friction, bodies}, closeness(rough), r);
}

void ContactGuess::setOpen() {
  r_.setZero();
  states_ = openStates(rows_);
}

void ContactGuess::startFrom(const Eigen::VectorXd& twists, bool rough, CoupledReport& report) {
  const Eigen::VectorXd w0 = velocities(twists);
  const FrictionReport friction = solveLaw(w0, rough, r_);
  report.friction_iterations += friction.iterations;
  states_ = contactStates(rows_, D_, D_ * r_ + w0, r_);
}

void ContactGuess::learnFrom(const Eigen::VectorXd& twists, double error) {
  const Eigen::VectorXd pushed = push();
  if (last_push_.size() > 0) {
    const Eigen::VectorXd dg = pushed - last_push_, dv = twists - last_twists_;
    const double speed = (rows_.J * twists).cwiseAbs().maxCoeff();
    // Below a certain change the solve's own error is all that there is to see.
    if ((rows_.J * dv).cwiseAbs().maxCoeff() > kLearnable * error * speed) update(dg, dv);
  }
  last_push_ = pushed;
  last_twists_ = twists;
}

// Symmetric rank-one update of K so that it gives the change of twists dv that impulses dg were seen to make; left
// alone where that would cost its definiteness.
void ContactGuess::update(const Eigen::VectorXd& dg, const Eigen::VectorXd& dv) {
  const Eigen::VectorXd miss = dv - bodies_.K * dg;
  const double curvature = miss.dot(dg);
  if (!(std::abs(curvature) > kLeastCurvature * miss.norm() * dg.norm())) return;
  const Eigen::MatrixXd next = bodies_.K + miss * miss.transpose() / curvature;
  if (curvature < 0.0 && Eigen::LLT<Eigen::MatrixXd>(next).info() != Eigen::Success) return;
  // The solution was made with the compliance that the rows had.
  const Eigen::VectorXd compliance = bodies_.compliance;
  setResponse(next);
  D_.diagonal() += compliance - bodies_.compliance;
  bodies_.compliance = compliance;
}

ContactGuess::Change ContactGuess::proceedFrom(const Eigen::VectorXd& twists, bool rough, CoupledReport& report) {
  const Eigen::VectorXd w = velocities(twists);
  // Shifted so that the small system reproduces this solution exactly.
  const Eigen::VectorXd w0 = w - D_ * r_ + bodies_.compliance.cwiseProduct(r_);
  Eigen::VectorXd next = r_;
  const FrictionReport friction = solveLaw(w0, rough, next);
  report.friction_iterations += friction.iterations;
  report.contact_residual = friction.residual;
  const double change = (D_ * (next - r_)).cwiseAbs().maxCoeff();
  const double scale = std::max((D_ * next).cwiseAbs().maxCoeff(), (w - rows_.bias).cwiseAbs().maxCoeff());
  // No closer than the small system is solved.
  const double small = std::max(closeness(rough), friction.residual);
  const double least = kSmallFloor * small * w0.cwiseAbs().maxCoeff() + kLeastSpeed;
  r_ = next;
  states_ = contactStates(rows_, D_, D_ * next + w0, next);
  return {friction.acceptable() && change <= std::max(settledAt(tolerance_) * scale, least),
          scale > 0.0 ? change / scale : 0.0};
}

}  // namespace monolith
