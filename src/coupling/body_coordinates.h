#pragma once
// The unknowns y of the bodies' motion: the twist of a free body; of bodies that joints connect as many as the
// velocities q of their joints and, where nothing holds it, the twist of the root (rigid/articulation.h), mixed. With v
// the twists of the n free bodies, among which those that hang on others count,
//
//   v = S y + v_0,   P v = y + P v_0,   P S = 1        S: 6n x y, v_0: what prescribed motions bring
//
// so that joints hold exactly, whichever way the step is solved, and the system is that of the free bodies between S^T
// and S. Forces on the bodies become S^T f; P^T g are forces f of S^T f = g. Without joints S is the identity.
//
// Mixed: y = L^T q with L L^T = S_q^T diag(scale^2) S_q + R, scale the one of each twist (step_problem.h) and R what
// resists the joints' motion. A joint between light and heavy bodies is easy to move while the heavy one stays, as hard
// as that one while the others do: errors of q would not tell which.

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <vector>

#include "rigid/rigid_body.h"

namespace monolith {

class BodyCoordinates {
 public:
  // Bodies that joints connect, or one alone. Their unknowns follow each other.
  struct Assembly {
    Eigen::Index first = 0, count = 0;
    std::vector<int> bodies;  // among all
    bool adrift = true;       // no body of it is held
  };

  // scale: of the twists of the free bodies; resistance: of all bodies' joints, impulse by velocity in the units of
  // scale^2, or empty. Without scales as if all were 1.
  void set(const std::vector<RigidBody>& bodies, const std::vector<Vector6d>& scale = {},
           const std::vector<double>& resistance = {});

  Eigen::Index size() const { return S_.cols(); }
  std::size_t bodies() const { return joint_.size(); }
  int joints() const;
  const Eigen::SparseMatrix<double>& S() const { return S_; }
  // q of y, and y of q: of what is known of q while bodies move and y is mixed anew.
  const Eigen::SparseMatrix<double>& Q() const { return Q_; }
  const Eigen::SparseMatrix<double>& Q_inverse() const { return Q_inverse_; }
  // Of free bodies, but for those whose motion is given altogether.
  const std::vector<Assembly>& assemblies() const { return assemblies_; }
  // Whether body b has a joint that is free to move, and then its velocity: q_b = row . y.
  bool hasJoint(std::size_t b) const { return joint_[b].size() > 0; }
  const Eigen::SparseVector<double>& jointRow(std::size_t b) const { return joint_[b]; }

  // Twists of, and impulses on, all bodies; only those of free bodies count and are set.
  Eigen::VectorXd gatherMotion(const std::vector<Vector6d>& all) const { return P_ * stack(all); }
  void scatterMotion(const Eigen::VectorXd& y, std::vector<Vector6d>& all) const { unstack(S_ * y, all); }
  Eigen::VectorXd gatherForces(const std::vector<Vector6d>& all) const { return S_.transpose() * stack(all); }
  void scatterForces(const Eigen::VectorXd& f, std::vector<Vector6d>& all) const { unstack(P_.transpose() * f, all); }

  // v_0 of all bodies, those that are not free included, whose twists `given` has.
  std::vector<Vector6d> carried(const std::vector<RigidBody>& bodies, const std::vector<Vector6d>& given) const;

 private:
  Eigen::VectorXd stack(const std::vector<Vector6d>& all) const;
  void unstack(const Eigen::VectorXd& v, std::vector<Vector6d>& all) const;

  std::vector<int> free_;                           // bodies
  std::vector<Eigen::SparseVector<double>> joint_;  // rows, of all bodies; empty without an unknown
  std::vector<Assembly> assemblies_;
  Eigen::SparseMatrix<double> S_, P_, Q_, Q_inverse_;
};

}  // namespace monolith
