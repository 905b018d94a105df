#include "solve/contact_system.h"

#include <utility>

namespace monolith {
namespace {

constexpr int kMostCorrections = 4;
constexpr double kRoundOff = 1e-14;  // of b
constexpr double kNoCloser = 0.5;

}  // namespace

ContactSystem::ContactSystem(const FrictionProblem& problem, std::vector<Eigen::Index> contacts,
                             std::vector<Eigen::Matrix3d> turn, std::vector<Eigen::Matrix3d> own)
    : problem_(problem),
      contacts_(std::move(contacts)),
      turn_(std::move(turn)),
      own_(std::move(own)),
      by_bodies_(problem.bodies != nullptr && problem.bodies->K.rows() < rows()) {
  by_bodies_ ? setByBodies() : setDense();
}

void ContactSystem::setDense() {
  std::vector<Eigen::Index> entry;
  for (const Eigen::Index c : contacts_) {
    for (int d = 0; d < 3; ++d) entry.push_back(problem_.entry(c, d));
  }
  Eigen::MatrixXd A = problem_.D(entry, entry);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    A.middleRows<3>(at) = (turn_[i] * A.middleRows<3>(at)).eval();
    A.block<3, 3>(at, at) += own_[i];
  }
  factor_.compute(A);
}

Eigen::Vector3d ContactSystem::compliance(Eigen::Index c) const {
  const Eigen::VectorXd& all = problem_.bodies->compliance;
  return {all[problem_.entry(c, 0)], all[problem_.entry(c, 1)], all[problem_.entry(c, 2)]};
}

void ContactSystem::setByBodies() {
  const BodyResponse& bodies = *problem_.bodies;
  Eigen::MatrixXd G = bodies.K_inverse;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const BodyResponse::Contact& contact = bodies.contacts[contacts_[i]];
    const Eigen::Matrix3d M = turn_[i] * compliance(contacts_[i]).asDiagonal() + own_[i];
    inverse_.push_back(M.inverse());
    const Eigen::Matrix3d moved = inverse_.back() * turn_[i];
    for (const auto& [row, J_row] : contact.of) {
      const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, 6, 3> pushed = J_row.transpose() * moved;
      for (const auto& [column, J_column] : contact.of) {
        G.block(row, column, J_row.cols(), J_column.cols()) += pushed * J_column;
      }
    }
  }
  factor_.compute(G);
}

Eigen::VectorXd ContactSystem::solveByBodies(const Eigen::VectorXd& b) const {
  const BodyResponse& bodies = *problem_.bodies;
  Eigen::VectorXd d(rows()), g = Eigen::VectorXd::Zero(bodies.K.rows());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    d.segment<3>(at) = inverse_[i] * b.segment<3>(at);
    bodies.contacts[contacts_[i]].push(d.segment<3>(at), g);
  }
  const Eigen::VectorXd y = factor_.solve(g);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    d.segment<3>(at) = inverse_[i] * (b.segment<3>(at) - turn_[i] * bodies.contacts[contacts_[i]].velocity(y));
  }
  return d;
}

Eigen::VectorXd ContactSystem::residual(const Eigen::VectorXd& b, const Eigen::VectorXd& d) const {
  const BodyResponse& bodies = *problem_.bodies;
  Eigen::VectorXd pushed = Eigen::VectorXd::Zero(bodies.K.rows()), out = b;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    bodies.contacts[contacts_[i]].push(d.segment<3>(static_cast<Eigen::Index>(3 * i)), pushed);
  }
  const Eigen::VectorXd moved = bodies.K * pushed;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    const BodyResponse::Contact& contact = bodies.contacts[contacts_[i]];
    const Eigen::Vector3d own = d.segment<3>(at);
    const Eigen::Vector3d velocity = contact.velocity(moved) + compliance(contacts_[i]).cwiseProduct(own);
    out.segment<3>(at) -= turn_[i] * velocity + own_[i] * own;
  }
  return out;
}

Eigen::VectorXd ContactSystem::solve(const Eigen::VectorXd& b) const {
  if (!by_bodies_) return factor_.solve(b);
  Eigen::VectorXd d = solveByBodies(b);
  double least = b.norm();
  const double goal = kRoundOff * least;
  for (int correction = 0; correction < kMostCorrections; ++correction) {
    const Eigen::VectorXd left = residual(b, d);
    const double now = left.norm();
    if (!(now > goal) || now > kNoCloser * least) break;
    least = now;
    d += solveByBodies(left);
  }
  return d;
}

}  // namespace monolith
