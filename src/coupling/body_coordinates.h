#pragma once
// The unknowns q of the bodies' motion: the twist of a free body, and of one that hangs on another the velocity of its
// joint (rigid/articulation.h). With v the twists of the n free bodies, one that hangs on another being free as well,
//
//   v = S q + v_0,   P v = q + P v_0,   P S = 1        S: 6n x q, v_0: what prescribed motions bring
//
// so that joints hold exactly, whichever way the step is solved, and the system is that of the free bodies between S^T
// and S. Forces on the bodies become S^T f; P^T g are forces f of S^T f = g. Without joints S is the identity.

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <vector>

#include "rigid/rigid_body.h"

namespace monolith {

class BodyCoordinates {
 public:
  // Bodies that joints connect. Their unknowns follow each other: of the root, where that is free, its twist.
  struct Assembly {
    Eigen::Index first = 0, count = 0;
    std::vector<int> bodies;  // among all
    bool adrift = true;       // no body of it is held
  };

  void set(const std::vector<RigidBody>& bodies);

  Eigen::Index size() const { return S_.cols(); }
  std::size_t bodies() const { return joint_.size(); }
  const Eigen::SparseMatrix<double>& S() const { return S_; }
  const Eigen::SparseMatrix<double>& P() const { return P_; }
  // Of free bodies, but for those whose motion is given altogether.
  const std::vector<Assembly>& assemblies() const { return assemblies_; }
  // Unknown of body b's joint; -1: none.
  Eigen::Index ofJoint(std::size_t b) const { return joint_[b]; }

  // Twists of, and impulses on, all bodies; only those of free bodies count and are set.
  Eigen::VectorXd gatherMotion(const std::vector<Vector6d>& all) const { return P_ * stack(all); }
  void scatterMotion(const Eigen::VectorXd& q, std::vector<Vector6d>& all) const { unstack(S_ * q, all); }
  Eigen::VectorXd gatherForces(const std::vector<Vector6d>& all) const { return S_.transpose() * stack(all); }
  void scatterForces(const Eigen::VectorXd& f, std::vector<Vector6d>& all) const { unstack(P_.transpose() * f, all); }

  // v_0 of all bodies, those that are not free included, whose twists `given` has.
  std::vector<Vector6d> carried(const std::vector<RigidBody>& bodies, const std::vector<Vector6d>& given) const;

 private:
  Eigen::VectorXd stack(const std::vector<Vector6d>& all) const;
  void unstack(const Eigen::VectorXd& v, std::vector<Vector6d>& all) const;

  std::vector<int> free_;            // bodies
  std::vector<Eigen::Index> joint_;  // of all bodies
  std::vector<Assembly> assemblies_;
  Eigen::SparseMatrix<double> S_, P_;
};

}  // namespace monolith
