#include "coupling/body_coordinates.h"

#include <algorithm>
#include <map>

#include "rigid/articulation.h"

namespace monolith {
namespace {

using Triplet = Eigen::Triplet<double>;

void addBlock(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& block, std::vector<Triplet>& to) {
  for (Eigen::Index j = 0; j < block.cols(); ++j) {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      if (block(i, j) == 0.0) continue;
      to.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
    }
  }
}

// v = S q and P v = q of the bodies of an assembly; q: the root's twist where that is free, then the joints'
// velocities.
struct JointVelocities {
  std::vector<Eigen::MatrixXd> S, P;  // of each body: 6 x q, q x 6
  std::vector<Eigen::Index> joint;    // q of its joint, or -1

  JointVelocities(const std::vector<RigidBody>& bodies, const BodyCoordinates::Assembly& assembly) {
    std::map<int, std::size_t> at;
    Eigen::Index next = assembly.adrift ? 6 : 0;
    for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
      const auto b = static_cast<std::size_t>(assembly.bodies[i]);
      at[assembly.bodies[i]] = i;
      S.emplace_back(Eigen::MatrixXd::Zero(6, assembly.count));
      P.emplace_back(Eigen::MatrixXd::Zero(assembly.count, 6));
      joint.push_back(bodies[b].hasFreeJoint() ? next++ : -1);
      if (!bodies[b].joint) {
        if (!assembly.adrift) continue;
        S[i].leftCols<6>().setIdentity();
        P[i].topRows<6>().setIdentity();
        continue;
      }
      const std::size_t parent = at.at(bodies[b].joint->parent);
      const Matrix6d X = carryMatrix(bodies, b);
      S[i] = X * S[parent];
      if (joint[i] < 0) continue;
      S[i].col(joint[i]) += jointTwist(bodies[b]);
      const Vector6d row = monolith::jointRow(bodies[b]);
      P[i].row(joint[i]) += row.transpose();
      P[parent].row(joint[i]) -= row.transpose() * X;
    }
  }
};

}  // namespace

void BodyCoordinates::set(const std::vector<RigidBody>& bodies, const std::vector<Vector6d>& scale,
                          const std::vector<double>& resistance) {
  const std::vector<int> roots = rootsOf(bodies);
  std::vector<std::vector<int>> members(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) members[roots[b]].push_back(static_cast<int>(b));
  free_.clear();
  joint_.assign(bodies.size(), {});
  assemblies_.clear();
  std::vector<Eigen::Index> place(bodies.size(), -1);  // among the free ones
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].motion != BodyMotion::kFree) continue;
    place[b] = static_cast<Eigen::Index>(free_.size());
    free_.push_back(static_cast<int>(b));
  }
  Eigen::Index size = 0;
  for (std::size_t root = 0; root < bodies.size(); ++root) {
    if (members[root].empty()) continue;
    Assembly assembly;
    assembly.first = size;
    assembly.bodies = members[root];
    assembly.adrift = bodies[root].motion == BodyMotion::kFree;
    assembly.count = assembly.adrift ? 6 : 0;
    for (const int b : members[root]) assembly.count += bodies[b].hasFreeJoint() ? 1 : 0;
    size += assembly.count;
    if (assembly.count > 0) assemblies_.push_back(assembly);
  }
  std::vector<Triplet> S, P, Q, Q_inverse;
  for (const Assembly& assembly : assemblies_) {
    if (assembly.bodies.size() == 1) {
      addBlock(6 * place[assembly.bodies[0]], assembly.first, Matrix6d::Identity(), S);
      addBlock(assembly.first, 6 * place[assembly.bodies[0]], Matrix6d::Identity(), P);
      addBlock(assembly.first, assembly.first, Matrix6d::Identity(), Q);
      addBlock(assembly.first, assembly.first, Matrix6d::Identity(), Q_inverse);
      continue;
    }
    const JointVelocities q(bodies, assembly);
    Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(assembly.count, assembly.count);
    for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
      const int b = assembly.bodies[i];
      if (place[b] < 0) continue;
      const Vector6d of = scale.empty() ? Vector6d(Vector6d::Ones()) : scale[place[b]];
      weight += q.S[i].transpose() * of.cwiseAbs2().asDiagonal() * q.S[i];
      if (q.joint[i] >= 0 && !resistance.empty()) weight(q.joint[i], q.joint[i]) += resistance[b];
    }
    const Eigen::MatrixXd L = weight.llt().matrixL();
    const Eigen::MatrixXd to_q =
        L.transpose().triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(assembly.count, assembly.count));
    addBlock(assembly.first, assembly.first, to_q, Q);
    addBlock(assembly.first, assembly.first, L.transpose(), Q_inverse);
    for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
      const int b = assembly.bodies[i];
      if (place[b] < 0) continue;
      addBlock(6 * place[b], assembly.first, q.S[i] * to_q, S);
      addBlock(assembly.first, 6 * place[b], L.transpose() * q.P[i], P);
      if (q.joint[i] < 0) continue;
      joint_[b].resize(size);
      for (Eigen::Index j = 0; j < assembly.count; ++j) {
        if (to_q(q.joint[i], j) != 0.0) joint_[b].insert(assembly.first + j) = to_q(q.joint[i], j);
      }
    }
  }
  const auto twists = static_cast<Eigen::Index>(6 * free_.size());
  const auto fill = [](Eigen::Index rows, Eigen::Index columns, const std::vector<Triplet>& from,
                       Eigen::SparseMatrix<double>& to) {
    to.resize(rows, columns);
    to.setFromTriplets(from.begin(), from.end());
  };
  fill(twists, size, S, S_);
  fill(size, twists, P, P_);
  fill(size, size, Q, Q_);
  fill(size, size, Q_inverse, Q_inverse_);
}

int BodyCoordinates::joints() const {
  return static_cast<int>(std::count_if(joint_.begin(), joint_.end(), [](const auto& row) { return row.size() > 0; }));
}

std::vector<Vector6d> BodyCoordinates::carried(const std::vector<RigidBody>& bodies,
                                               const std::vector<Vector6d>& given) const {
  std::vector<Vector6d> out(bodies.size(), Vector6d::Zero());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    if (!body.joint) {
      if (body.motion != BodyMotion::kFree) out[b] = given[b];
      continue;
    }
    out[b] = carryMatrix(bodies, b) * out[body.joint->parent];
    if (body.joint->prescribed) out[b] += body.joint_velocity * jointTwist(body);
  }
  return out;
}

Eigen::VectorXd BodyCoordinates::stack(const std::vector<Vector6d>& all) const {
  Eigen::VectorXd out(S_.rows());
  for (std::size_t i = 0; i < free_.size(); ++i) out.segment<6>(6 * i) = all[free_[i]];
  return out;
}

void BodyCoordinates::unstack(const Eigen::VectorXd& v, std::vector<Vector6d>& all) const {
  for (std::size_t i = 0; i < free_.size(); ++i) all[free_[i]] = v.segment<6>(6 * i);
}

}  // namespace monolith
