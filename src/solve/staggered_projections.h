#pragma once
// Coulomb friction on a small dense system by staggered projections (Kaufman, Sueda, James & Pai 2008, ACM TOG 27(5)):
//   w = D r + w0,   r = (lambda_0..lambda_m-1, f_0..f_2m-1),  w likewise (normal, tangential velocities)
// normal problem, f given:         0 <= lambda, 0 <= w_n, lambda . w_n = 0
// friction problem, lambda given:  min over |f_c| <= mu_c lambda_c of 1/2 f^T D_tt f + (D_tn lambda + w0_t)^T f
// alternated to a fixed point. There each contact obeys Coulomb's law: f inside the cone, and on it, opposite to w_t,
// where it slips. Alternation contracts linearly and may not at all (large mu with a strong coupling of normal and tangent); so
// Newton's method on the law itself (Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92, 353) is tried from
// its iterates, and the law is solved contact by contact (non-smooth contact dynamics: Jean 1999, ibid. 177, 235) if all else fails.
//
// What counts is how well the law holds, in velocities: impulses of redundant contacts (four corners of a box) are not determined.

#include <Eigen/Dense>

namespace monolith {

// Many redundant contacts near the limit of their friction (an arch about to fall) may leave the law short of its
// tolerance: a residual up to this is accepted, and reported.
constexpr double kAcceptableLaw = 1e-3;

struct FrictionReport {
  bool solved = false;
  bool staggered = true;  // false: by contact-wise sweeps
  int iterations = 0;     // alternations and Newton steps, then sweeps
  double residual = 0.0;  // of the law, relative to the largest velocity of w0

  bool acceptable() const { return solved || residual <= kAcceptableLaw; }
};

// How far r is from Coulomb's law, as a velocity: |r - P(r - w/D_cc)| D_cc with the projection P onto each contact's cone.
double coulombResidual(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu,
                       const Eigen::VectorXd& r);

// r: start on entry, on return the solution or, unsolved, what came closest to it.
[[nodiscard]] FrictionReport solveFrictionalContact(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0,
                                                    const Eigen::VectorXd& mu, double tolerance, Eigen::VectorXd& r);

}  // namespace monolith
