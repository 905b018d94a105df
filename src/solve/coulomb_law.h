#pragma once
// Coulomb friction at m contacts, as a small dense system:
//   w = D r + w0,   r = (lambda_0..lambda_m-1, f_0..f_2m-1),  w likewise (normal, tangential velocities)
//   0 <= lambda, 0 <= w_n, lambda w_n = 0;   |f| <= mu lambda; where it slips |f| = mu lambda, opposite to w_t
// D symmetric, positive definite (if only just: contacts may be redundant).
//
// What counts is how well the law holds, in velocities: impulses of redundant contacts (four corners of a box) are not
// determined.

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace monolith {

// What the contacts' response is made of, D = J K J^T + C: the bodies' own to impulses, K, and the contacts'
// compliance.
struct BodyResponse {
  struct Contact {
    // Its rows of J, the normal's first, of unknowns that follow each other; with the first of them.
    using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 6>;
    std::vector<std::pair<Eigen::Index, Rows>> of;

    Eigen::Vector3d velocity(const Eigen::VectorXd& motion) const {
      Eigen::Vector3d out = Eigen::Vector3d::Zero();
      for (const auto& [first, J] : of) out += J * motion.segment(first, J.cols());
      return out;
    }
    void push(const Eigen::Vector3d& impulse, Eigen::VectorXd& bodies) const {
      for (const auto& [first, J] : of) bodies.segment(first, J.cols()) += J.transpose() * impulse;
    }
  };
  std::vector<Contact> contacts;
  Eigen::MatrixXd K, K_inverse;
  Eigen::VectorXd compliance;  // in the order of r
};

struct FrictionProblem {
  const Eigen::MatrixXd& D;   // 3m x 3m
  const Eigen::VectorXd& w0;  // 3m, m/s
  const Eigen::VectorXd& mu;  // m
  const BodyResponse* bodies = nullptr;  // of which D is made, if that is known: solutions are the same, but sooner

  Eigen::Index count() const { return mu.size(); }
  // In r, of the normal (0) or a tangent (1, 2) of a contact.
  Eigen::Index entry(Eigen::Index c, int d) const { return d == 0 ? c : count() + 2 * c + d - 1; }
  // Steps of the projection below, inverse to the contact's own response.
  double normalStep(Eigen::Index c) const { return 1.0 / D(c, c); }
  double tangentStep(Eigen::Index c) const {
    const Eigen::Index t = count() + 2 * c;
    return 1.0 / std::max(D(t, t), D(t + 1, t + 1));
  }
};

// How far r is from Coulomb's law, as a velocity: |r - P(r - w/D_cc)| D_cc with the projection P onto each contact's
// cone.
double coulombResidual(const FrictionProblem& problem, const Eigen::VectorXd& r);

// The impulses that have come closest to the law so far, of all methods.
class ClosestToLaw {
 public:
  // goal: residual (m/s) that is close enough.
  ClosestToLaw(const FrictionProblem& problem, double goal) : problem_(problem), goal_(goal) {}

  // Returns whether that is close enough; the candidate's residual in any case.
  bool offer(const Eigen::VectorXd& candidate, double* its_residual = nullptr);

  bool arrived() const { return residual_ <= goal_; }
  const Eigen::VectorXd& impulses() const { return r_; }
  double residual() const { return residual_; }

 private:
  const FrictionProblem& problem_;
  double goal_;
  Eigen::VectorXd r_;
  double residual_ = std::numeric_limits<double>::infinity();
};

}  // namespace monolith
