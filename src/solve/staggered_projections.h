#pragma once
// Coulomb friction on a small dense system by staggered projections (Kaufman, Sueda, James & Pai 2008, ACM TOG 27(5)):
//   w = D r + w0,   r = (lambda_0..lambda_m-1, f_0..f_2m-1),  w likewise (normal, tangential velocities)
// normal problem, f given:         0 <= lambda, 0 <= w_n, lambda . w_n = 0
// friction problem, lambda given:  min over |f_c| <= mu_c lambda_c of 1/2 f^T D_tt f + (D_tn lambda + w0_t)^T f
// alternated to a fixed point. There each contact obeys Coulomb's law: f inside the cone, and on it, opposite to w_t,
// where it slips. The alternation need not contract (large mu with a strong coupling of normal and tangent); then the same
// law is solved contact by contact (non-smooth contact dynamics: Jean 1999, Comput. Methods Appl. Mech. Eng. 177, 235).
//
// Convergence is judged by velocities: impulses of redundant contacts (four corners of a box) are not determined.

#include <Eigen/Dense>

namespace monolith {

struct FrictionReport {
  bool solved = false;
  bool staggered = true;  // false: by contact-wise sweeps
  int iterations = 0;     // alternations, then sweeps
  double residual = 0.0;  // largest change of a velocity in the last one, relative to the largest of w0
};

// r: start on entry (only its friction part counts), solution on return.
[[nodiscard]] FrictionReport solveFrictionalContact(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0,
                                                    const Eigen::VectorXd& mu, double tolerance, Eigen::VectorXd& r);

}  // namespace monolith
