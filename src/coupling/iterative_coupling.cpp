#include "coupling/iterative_coupling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "solve/staggered_projections.h"

namespace monolith {
namespace {

constexpr int kMaximumAlternations = 500;
constexpr double kSmallTolerance = 1e-9;
constexpr std::size_t kHistory = 8;
constexpr double kGrowth = 2.0;  // of the residual, after which the history is dropped

// Anderson mixing (Walker & Ni 2011, SIAM J. Numer. Anal. 49, 1715) of a fixed point g = G(g): plain alternation
// contracts by the liquid's share of the resistance, which is nearly one for light bodies and thick liquids.
class Mixing {
 public:
  Eigen::VectorXd next(const Eigen::VectorXd& g, const Eigen::VectorXd& image) {
    const Eigen::VectorXd residual = image - g;
    // Where contacts change what they do the map has a kink, and what was learnt on its other side misleads.
    const double size = residual.norm();
    if (size > kGrowth * least_) {
      residuals_.clear();
      images_.clear();
      last_residual_.resize(0);
      least_ = size;
      return image;
    }
    least_ = std::min(least_, size);
    if (last_residual_.size() > 0) {
      residuals_.push_back(residual - last_residual_);
      images_.push_back(image - last_image_);
      if (residuals_.size() > kHistory) {
        residuals_.erase(residuals_.begin());
        images_.erase(images_.begin());
      }
    }
    last_residual_ = residual;
    last_image_ = image;
    if (residuals_.empty()) return image;
    const auto columns = static_cast<Eigen::Index>(residuals_.size());
    Eigen::MatrixXd R(g.size(), columns), I(g.size(), columns);
    for (Eigen::Index i = 0; i < columns; ++i) {
      R.col(i) = residuals_[i];
      I.col(i) = images_[i];
    }
    return image - I * R.colPivHouseholderQr().solve(residual);
  }

 private:
  std::vector<Eigen::VectorXd> residuals_, images_;  // differences
  Eigen::VectorXd last_residual_, last_image_;
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace

CoupledReport solveIteratively(StepSolver& solver, const StepProblem& problem, const StepVector& rhs,
                               const ContactRows& contacts, const CoupledOptions& options, StepVector& x,
                               Eigen::VectorXd& r) {
  const Eigen::Index n = problem.bodyUnknowns();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b < problem.free.size(); ++b) {
    M.block<6, 6>(6 * b, 6 * b) = problem.inertia[b];
    K.block<6, 6>(6 * b, 6 * b) = problem.inertia[b].inverse();
  }
  Eigen::VectorXd compliance;
  const Eigen::MatrixXd D = contactResponse(contacts, K, compliance);
  if (r.size() != 3 * contacts.count()) r = Eigen::VectorXd::Zero(3 * contacts.count());
  CoupledReport report;
  StepVector pushed = rhs;
  double change = 0.0;
  Mixing mixing;
  Eigen::VectorXd push = contacts.J.transpose() * r;
  for (int it = 0; it < kMaximumAlternations; ++it) {
    // Pressure, viscosity and bodies.
    scatterBodies(problem, gatherBodies(problem, rhs.bodies) + push, pushed.bodies);
    const CoupledReport liquid = solver.solve(pushed, options, x);
    report.iterations += liquid.iterations;
    report.solves += liquid.solves;
    report.residual = liquid.residual;
    if (liquid.status != CoupledReport::Status::kConverged) {
      report.status = liquid.status;
      report.message = liquid.message;
      return report;
    }
    // Contact alone: what the bodies would do under the liquid's forces just found.
    const Eigen::VectorXd v = gatherBodies(problem, x.bodies);
    const Eigen::VectorXd w = contacts.J * (v - K * push) + contacts.bias;
    const FrictionReport friction = solveFrictionalContact(D, w, contacts.friction, kSmallTolerance, r);
    report.friction_iterations += 1;
    const Eigen::VectorXd next = contacts.J.transpose() * r;
    const double size = std::max({next.dot(K * next), push.dot(K * push), v.dot(M * v), 1e-300});
    change = std::sqrt((next - push).dot(K * (next - push)) / size);
    if (friction.solved && change <= options.tolerance) {
      report.status = CoupledReport::Status::kConverged;
      return report;
    }
    push = mixing.next(push, next);
  }
  std::ostringstream text;
  text << "pressure and contact did not agree after " << kMaximumAlternations
       << " alternations: the impulses still change by " << change;
  report.status = CoupledReport::Status::kNotConverged;
  report.message = text.str();
  return report;
}

}  // namespace monolith
