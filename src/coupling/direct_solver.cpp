#include "coupling/direct_solver.h"

#include <Eigen/CholmodSupport>
#include <sstream>

#include "coupling/stress_system.h"
#include "solve/frictional_contact.h"

namespace monolith {
namespace {

constexpr int kRefinements = 3;
constexpr double kSmallTolerance = 1e-9;
// Weight that pins one pressure of each sealed region; the border takes its effect back where the constant matters.
constexpr double kPin = 1.0;

}  // namespace

struct DirectSolver::Impl {
  StepProblem* problem = nullptr;
  std::unique_ptr<StressSystem> system;
  Eigen::CholmodSupernodalLLT<StressSystem::Sparse> factor;
  StressSystem::Sparse B;   // J and the pins whose effect is taken back
  Eigen::MatrixXd A_inverse_B;
  Eigen::PartialPivLU<Eigen::MatrixXd> small;
  Eigen::MatrixXd K;
  std::string failure;

  void prepare(StepProblem& p);
  // One solution of the whole system, without refinement; x holds the answer.
  void backSubstitute(const StepVector& rhs, StepVector& x) const;
  CoupledReport solve(const StepVector& rhs, double tolerance, StepVector& x) const;
};

void DirectSolver::Impl::prepare(StepProblem& p) {
  problem = &p;
  failure.clear();
  system = std::make_unique<StressSystem>(p);
  const StressSystem& s = *system;
  const Eigen::Index n = p.bodyUnknowns();
  StressSystem::Sparse A = s.A;
  std::vector<Eigen::Index> given_back;
  for (const PressureRegion& region : p.regions) {
    if (!region.sealed) continue;
    const auto place = std::find(s.pressure_cells.begin(), s.pressure_cells.end(), region.runs.front().begin);
    const Eigen::Index i = s.stresses + (place - s.pressure_cells.begin());
    A.coeffRef(i, i) += kPin;
    if (!region.null_mode) given_back.push_back(i);
  }
  const auto border = static_cast<Eigen::Index>(given_back.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < s.J.outerSize(); ++k) {
    for (StressSystem::Sparse::InnerIterator it(s.J, k); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(it.col()), it.value());
    }
  }
  for (Eigen::Index k = 0; k < border; ++k) {
    entries.emplace_back(static_cast<int>(given_back[k]), static_cast<int>(n + k), kPin);
  }
  B.resize(s.unknowns(), n + border);
  B.setFromTriplets(entries.begin(), entries.end());
  if (s.unknowns() > 0) factor.compute(A);
  if (s.unknowns() > 0 && factor.info() != Eigen::Success) {
    failure = "CHOLMOD could not factor the stress system of " + std::to_string(s.unknowns()) + " unknowns";
    return;
  }
  // CHOLMOD takes no right side of no columns.
  A_inverse_B.resize(s.unknowns(), n + border);
  if (A_inverse_B.size() > 0) A_inverse_B = factor.solve(Eigen::MatrixXd(B));
  Eigen::MatrixXd S = B.transpose() * A_inverse_B;
  S = 0.5 * (S + S.transpose()).eval();
  S.topLeftCorner(n, n) += p.bodyInertia();
  S.bottomRightCorner(border, border).diagonal().array() -= kPin;
  if (S.size() > 0) small.compute(S);
  K = S.size() > 0 ? Eigen::MatrixXd(small.inverse().topLeftCorner(n, n)) : Eigen::MatrixXd(0, 0);
}

void DirectSolver::Impl::backSubstitute(const StepVector& rhs, StepVector& x) const {
  const StressSystem& s = *system;
  const Eigen::VectorXd f = s.faceForces(rhs);
  const Eigen::VectorXd c = s.G * s.inverse_mass.cwiseProduct(f) - s.flux(rhs);
  Eigen::VectorXd solution = s.unknowns() > 0 ? Eigen::VectorXd(factor.solve(c)) : c;
  if (B.cols() > 0) {
    Eigen::VectorXd g = -(B.transpose() * solution);
    g.head(problem->bodyUnknowns()) += problem->coordinates.gatherForces(rhs.bodies);
    const Eigen::VectorXd z = small.solve(g);
    solution += A_inverse_B * z;
    problem->coordinates.scatterMotion(z.head(problem->bodyUnknowns()), x.bodies);
  }
  s.velocityAndPressure(solution, f, x);
}

CoupledReport DirectSolver::Impl::solve(const StepVector& rhs, double tolerance, StepVector& x) const {
  CoupledReport report;
  if (!failure.empty()) {
    report.status = SolveStatus::kNotConverged;
    report.message = failure;
    return report;
  }
  backSubstitute(rhs, x);
  report.solves = 1;
  StepVector residual, correction;
  correction.resize(problem->grid.lattice, problem->bodies->size());
  for (int it = 0;; ++it) {
    stepResidual(*problem, rhs, x, residual);
    report.residual = relativeNorm(*problem, residual, rhs);
    if (report.residual <= tolerance) break;
    if (it == kRefinements) {
      std::ostringstream text;
      text << "the direct solve reached a relative residual of " << report.residual << "; wanted " << tolerance;
      report.message = text.str();
      report.status = SolveStatus::kNotConverged;
      return report;
    }
    correction.setZero();
    backSubstitute(residual, correction);
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < x.velocity[a].size(); ++i) x.velocity[a][i] += correction.velocity[a][i];
    }
    for (std::size_t i = 0; i < x.pressure.size(); ++i) x.pressure[i] += correction.pressure[i];
    for (const int b : problem->free) x.bodies[b] += correction.bodies[b];
  }
  report.status = SolveStatus::kConverged;
  return report;
}

DirectSolver::DirectSolver() : impl_(std::make_unique<Impl>()) {}
DirectSolver::~DirectSolver() = default;

void DirectSolver::prepare(StepProblem& problem) { impl_->prepare(problem); }

CoupledReport DirectSolver::solve(StepVector& rhs, const CoupledOptions& options, StepVector& x) {
  return impl_->solve(rhs, options.tolerance, x);
}

CoupledReport DirectSolver::solveWithContacts(StepVector& rhs, const ContactRows& contacts,
                                              const CoupledOptions& options, StepVector& x, Eigen::VectorXd& r) {
  const StepProblem& p = *impl_->problem;
  CoupledReport report = impl_->solve(rhs, options.tolerance, x);
  if (report.status != SolveStatus::kConverged || contacts.count() == 0) return report;
  Eigen::VectorXd compliance;
  const Eigen::MatrixXd D = contactResponse(contacts, impl_->K, compliance);
  const Eigen::VectorXd w = contacts.J * p.coordinates.gatherMotion(x.bodies) + contacts.bias;
  const FrictionReport friction = solveFrictionalContact({D, w, contacts.friction}, kSmallTolerance, r);
  StepVector pushed = rhs;
  p.coordinates.scatterForces(p.coordinates.gatherForces(rhs.bodies) + contacts.J.transpose() * r, pushed.bodies);
  CoupledReport second = impl_->solve(pushed, options.tolerance, x);
  second.solves += report.solves;
  second.friction_iterations = friction.iterations;
  second.contact_residual = friction.residual;
  if (!friction.acceptable() && second.status == SolveStatus::kConverged) {
    std::ostringstream text;
    text << "friction of " << contacts.count() << " contacts did not reach its fixed point: their velocities miss "
         << "Coulomb's law by " << friction.residual << " of the largest; accepted is " << kAcceptableLaw;
    second.status = SolveStatus::kNotConverged;
    second.message = text.str();
  }
  return second;
}

}  // namespace monolith
