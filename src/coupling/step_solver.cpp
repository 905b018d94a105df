#include "coupling/step_solver.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>

#include "solve/blocked_sum.h"

namespace monolith {

void addCompliance(const ContactRows& contacts, Eigen::MatrixXd& response, Eigen::VectorXd& compliance) {
  const Eigen::Index m = contacts.count();
  std::vector<double> largest(contacts.pair.size(), 0.0);
  const auto pairOf = [&](Eigen::Index row) { return contacts.pair[row < m ? row : (row - m) / 2]; };
  for (Eigen::Index i = 0; i < response.rows(); ++i) largest[pairOf(i)] = std::max(largest[pairOf(i)], response(i, i));
  compliance.resize(response.rows());
  for (Eigen::Index i = 0; i < response.rows(); ++i) {
    compliance[i] = kContactCompliance * contacts.softness[i] * largest[pairOf(i)];
  }
  response.diagonal() += compliance;
}

Eigen::MatrixXd contactResponse(const ContactRows& contacts, const Eigen::MatrixXd& K, Eigen::VectorXd& compliance) {
  // A contact involves two bodies.
  const Eigen::SparseMatrix<double, Eigen::RowMajor> J = contacts.J.sparseView();
  const Eigen::MatrixXd moved = J * K;
  Eigen::MatrixXd D = moved * J.transpose();
  D = 0.5 * (D + D.transpose()).eval();
  addCompliance(contacts, D, compliance);
  return D;
}

double stepNorm(const StepProblem& problem, const StepVector& r) {
  double sum = 0.0;
  for (const auto& field : r.velocity) sum += dot(field, field);
  sum += dot(r.pressure, r.pressure);
  return std::hypot(std::sqrt(sum), bodiesNorm(problem, problem.coordinates.gatherForces(r.bodies)));
}

double bodiesNorm(const StepProblem& problem, const Eigen::VectorXd& impulses) {
  return impulses.cwiseQuotient(problem.unknown_scale).norm();
}

void stepResidual(const StepProblem& problem, const StepVector& rhs, const StepVector& x, StepVector& residual) {
  StepVector unknown = x;
  for (std::size_t b = 0; b < problem.bodies->size(); ++b) {
    if (problem.free_index[b] < 0) unknown.bodies[b].setZero();
  }
  problem.apply(unknown, residual);
  const auto subtract = [](const auto& from, auto& field) {
    for (std::size_t i = 0; i < field.size(); ++i) field[i] = from[i] - field[i];
  };
  for (int a = 0; a < 3; ++a) subtract(rhs.velocity[a], residual.velocity[a]);
  subtract(rhs.pressure, residual.pressure);
  subtract(rhs.bodies, residual.bodies);
}

double relativeNorm(const StepProblem& problem, const StepVector& residual, const StepVector& rhs) {
  const double scale = stepNorm(problem, rhs);
  return scale == 0.0 ? 0.0 : stepNorm(problem, residual) / scale;
}

}  // namespace monolith
