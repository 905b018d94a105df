// The rows that contacts border the linear system with: on a system small enough to solve here, without liquid.

#include "coupling/contact_states.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "coupling/step_solver.h"
#include "solve/frictional_contact.h"

namespace monolith {
namespace {

struct Small {
  ContactRows rows;
  Eigen::MatrixXd K, D;
  Eigen::VectorXd compliance, w0;

  explicit Small(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    constexpr int kContacts = 3, kUnknowns = 12;
    const auto draw = [&] { return normal(random); };
    rows.J = Eigen::MatrixXd::NullaryExpr(3 * kContacts, kUnknowns, draw);
    rows.bias = Eigen::VectorXd::NullaryExpr(3 * kContacts, draw);
    rows.bias.head(kContacts).array() -= 4.0;  // they press
    rows.friction = Eigen::VectorXd::Constant(kContacts, 0.2);
    rows.softness = Eigen::VectorXd::Ones(3 * kContacts);
    rows.pair = {0, 1, 2};
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(kUnknowns, kUnknowns, draw);
    K = root * root.transpose() / kUnknowns + 0.5 * Eigen::MatrixXd::Identity(kUnknowns, kUnknowns);
    D = contactResponse(rows, K, compliance);
    w0 = rows.bias;
  }

  double residual(const Eigen::VectorXd& r) const { return coulombResidual({D, w0, rows.friction}, r); }

  // Impulses that the bordered system gives for what the contacts do at r.
  Eigen::VectorXd step(const Eigen::VectorXd& r) const {
    const ContactStates states = contactStates(rows, D, D * r + w0, r);
    const ContactBorder border = makeBorder(rows, states);
    Eigen::MatrixXd response = border.R * K * border.C;
    response.diagonal() += border.mobility;
    return impulses(rows, states, border, response.partialPivLu().solve(-border.bias));
  }
};

TEST(ContactStates, BorderIsNewtonsMethodForCoulombsLaw) {
  int slipping = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Small small(seed);
    Eigen::VectorXd r;
    ASSERT_TRUE(solveFrictionalContact({small.D, small.w0, small.rows.friction}, 1e-12, r).solved);
    const ContactStates states = contactStates(small.rows, small.D, small.D * r + small.w0, r);
    slipping += static_cast<int>(std::count(states.state.begin(), states.state.end(), ContactState::kSlip));
    EXPECT_LT(small.residual(small.step(r)), 1e-7) << "does not stay at the answer, seed " << seed;
    // From an answer that is off by part in size and direction: the error is squared.
    std::vector<double> error;
    for (const double part : {1e-2, 1e-3}) {
      Eigen::VectorXd off = r;
      for (Eigen::Index i = 0; i < off.size(); ++i) off[i] *= 1.0 + part * std::cos(1.0 + 2.0 * static_cast<double>(i));
      error.push_back((small.step(off) - r).norm() / r.norm());
    }
    EXPECT_LT(error[0], 1e-3) << "seed " << seed;
    EXPECT_LT(error[1], 1e-5) << "seed " << seed;
  }
  EXPECT_GT(slipping, 20);
}

}  // namespace
}  // namespace monolith
