#include "coupling/body_coordinates.h"

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

bool hasUnknown(const RigidBody& body) { return body.joint && !body.joint->prescribed; }

}  // namespace

void BodyCoordinates::set(const std::vector<RigidBody>& bodies) {
  const std::vector<int> roots = rootsOf(bodies);
  std::vector<std::vector<int>> members(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) members[roots[b]].push_back(static_cast<int>(b));
  free_.clear();
  joint_.assign(bodies.size(), -1);
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
    if (assembly.adrift) size += 6;
    for (const int b : members[root]) {
      if (hasUnknown(bodies[b])) joint_[b] = size++;
    }
    assembly.count = size - assembly.first;
    if (assembly.count > 0) assemblies_.push_back(assembly);
  }
  std::vector<Triplet> S, P;
  std::vector<Eigen::MatrixXd> columns(bodies.size());  // of S, of an assembly's unknowns
  for (const Assembly& assembly : assemblies_) {
    for (const int b : assembly.bodies) {
      Eigen::MatrixXd& own = columns[b];
      if (!bodies[b].joint) {
        own = Eigen::MatrixXd::Zero(6, assembly.count);
        if (!assembly.adrift) continue;
        own.leftCols<6>().setIdentity();
        addBlock(assembly.first, 6 * place[b], Matrix6d::Identity(), P);
      } else {
        const int parent = bodies[b].joint->parent;
        const Matrix6d X = carryMatrix(bodies, b);
        own = X * columns[parent];
        if (joint_[b] >= 0) {
          own.col(joint_[b] - assembly.first) += jointTwist(bodies[b]);
          const Eigen::RowVectorXd row = jointRow(bodies[b]).transpose();
          addBlock(joint_[b], 6 * place[b], row, P);
          if (place[parent] >= 0) addBlock(joint_[b], 6 * place[parent], -row * X, P);
        }
      }
      addBlock(6 * place[b], assembly.first, own, S);
    }
  }
  const auto twists = static_cast<Eigen::Index>(6 * free_.size());
  S_.resize(twists, size);
  S_.setFromTriplets(S.begin(), S.end());
  P_.resize(size, twists);
  P_.setFromTriplets(P.begin(), P.end());
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
