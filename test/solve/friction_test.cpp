#include <gtest/gtest.h>

#include <random>

#include "solve/cone_interior_point.h"
#include "solve/contact_sweeps.h"
#include "solve/contact_system.h"
#include "solve/disc_qp.h"
#include "solve/frictional_contact.h"
#include "solve/staggered_projections.h"

namespace monolith {
namespace {

Eigen::MatrixXd randomSpd(std::mt19937& random, Eigen::Index n, Eigen::Index rank, double shift) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd B(n, rank);
  for (Eigen::Index i = 0; i < B.size(); ++i) B.data()[i] = normal(random);
  return B * B.transpose() + shift * Eigen::MatrixXd::Identity(n, n);
}

Eigen::VectorXd randomVector(std::mt19937& random, Eigen::Index n) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(n);
  for (double& x : v) x = normal(random);
  return v;
}

TEST(DiscQp, OneDiscMeetsItsOptimality) {
  std::mt19937 random(1);
  int on_edge = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix2d B = randomSpd(random, 2, 2, 1e-3);
    const Eigen::Vector2d g = randomVector(random, 2);
    const double radius = std::exp(randomVector(random, 1)[0]);
    const Eigen::Vector2d x = DiscMinimiser(B).minimise(g, radius);
    const Eigen::Vector2d gradient = B * x + g;
    ASSERT_LE(x.norm(), radius * (1.0 + 1e-12));
    if (x.norm() < radius * (1.0 - 1e-9)) {
      EXPECT_LT(gradient.norm(), 1e-9 * g.norm());
    } else {
      ++on_edge;
      // The gradient points inwards along the radius.
      EXPECT_LT((gradient.normalized() + x.normalized()).norm(), 1e-6) << trial;
    }
  }
  EXPECT_GT(on_edge, 20);
  EXPECT_LT(on_edge, 180);
}

TEST(DiscQp, NoFeasiblePointIsBetter) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Index discs = 5;
    const Eigen::MatrixXd A = randomSpd(random, 2 * discs, trial % 2 ? 3 : 10, 1e-6);
    const Eigen::VectorXd q = randomVector(random, 2 * discs);
    const Eigen::VectorXd radius = randomVector(random, discs).cwiseAbs();
    Eigen::VectorXd f;
    ASSERT_TRUE(DiscQp(A).solve(q, radius, 1e-12, 20000, f).solved);
    const auto objective = [&](const Eigen::VectorXd& x) { return 0.5 * x.dot(A * x) + q.dot(x); };
    for (int other = 0; other < 200; ++other) {
      Eigen::VectorXd x = f + 0.1 * std::pow(10.0, -(other % 5)) * randomVector(random, 2 * discs);
      for (Eigen::Index c = 0; c < discs; ++c) {
        const double length = x.segment<2>(2 * c).norm();
        if (length > radius[c]) x.segment<2>(2 * c) *= radius[c] / length;
      }
      EXPECT_GE(objective(x), objective(f) - 1e-9);
    }
  }
}

// Coulomb's law at every contact, to a tolerance in velocity.
void expectLaw(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu, const Eigen::VectorXd& r,
               double tolerance) {
  const Eigen::Index m = mu.size();
  const Eigen::VectorXd w = D * r + w0;
  const double scale = w0.cwiseAbs().maxCoeff();
  for (Eigen::Index c = 0; c < m; ++c) {
    EXPECT_GE(r[c], 0.0);
    EXPECT_GE(w[c], -tolerance * scale);
    EXPECT_LT(std::min(r[c] / std::max(r.cwiseAbs().maxCoeff(), 1e-300), w[c] / scale), tolerance);
    const Eigen::Vector2d f = r.segment<2>(m + 2 * c), slip = w.segment<2>(m + 2 * c);
    EXPECT_LE(f.norm(), mu[c] * r[c] * (1.0 + 1e-9));
    if (mu[c] > 0.0 && slip.norm() > 1e3 * tolerance * scale && r[c] > 1e-4 * r.cwiseAbs().maxCoeff()) {
      EXPECT_LT((f / (mu[c] * r[c]) + slip.normalized()).norm(), 1e-3);
    }
  }
}

TEST(FrictionalContact, BlockOnAPlane) {
  // A point of mass 2 pushed down and sideways: D = 1/2.
  const Eigen::MatrixXd D = 0.5 * Eigen::MatrixXd::Identity(3, 3);
  const Eigen::VectorXd w0 = Eigen::Vector3d(-1.0, 0.3, 0.0);
  for (const double friction : {0.0, 0.2, 0.5}) {
    const Eigen::VectorXd mu = Eigen::VectorXd::Constant(1, friction);
    const FrictionProblem problem{D, w0, mu};
    const Eigen::Vector3d expected(2.0, -std::min(2.0 * friction, 0.6), 0.0);
    Eigen::VectorXd r;
    ASSERT_TRUE(solveFrictionalContact(problem, 1e-12, r).solved);
    EXPECT_LT((r - expected).norm(), 1e-10);
    ClosestToLaw closest(problem, 1e-9);
    findInteriorPoint(problem, closest);
    ASSERT_TRUE(closest.arrived()) << friction;
    EXPECT_LT((closest.impulses() - expected).norm(), 1e-7) << friction;
  }
}

TEST(FrictionalContact, RandomContactsObeyCoulombsLaw) {
  std::mt19937 random(3);
  int solved = 0, staggered = 0, interior = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index m = 1 + trial % 8;
    // Fewer degrees of freedom than rows: redundant contacts.
    Eigen::MatrixXd D = randomSpd(random, 3 * m, 6, 0.0);
    D.diagonal().array() += 1e-9 * D.diagonal().maxCoeff();
    Eigen::VectorXd mu = 0.4 * randomVector(random, m).cwiseAbs();
    const Eigen::VectorXd feasible = randomVector(random, 3 * m).cwiseAbs();
    Eigen::VectorXd w0 = -D * feasible;  // a configuration that some impulses can bring to rest
    const FrictionProblem problem{D, w0, mu};
    SCOPED_TRACE(trial);
    Eigen::VectorXd r;
    if (solveFrictionalContact(problem, 1e-9, r).solved) {
      ++solved;
      expectLaw(D, w0, mu, r, 1e-6);
    }
    const double goal = 1e-7 * w0.cwiseAbs().maxCoeff();
    ClosestToLaw by_turns(problem, goal), inside(problem, goal);
    alternateProjections(problem, Eigen::VectorXd::Zero(3 * m), by_turns);
    staggered += by_turns.arrived();
    findInteriorPoint(problem, inside);
    interior += inside.arrived();
    if (inside.arrived()) expectLaw(D, w0, mu, inside.impulses(), 1e-5);
  }
  // Random couplings of normals and tangents are harsher than bodies' own.
  EXPECT_GE(solved, 54);
  EXPECT_GE(staggered, 45);
  EXPECT_GE(interior, 45);
}

// A heap: each of `bodies` lies with five points on those below it or on the floor, at rest but for gravity.
struct Heap {
  Eigen::MatrixXd D;
  Eigen::VectorXd w0, mu;
  BodyResponse response;

  Heap(unsigned seed, Eigen::Index bodies, double friction) {
    std::mt19937 random(seed);
    constexpr Eigen::Index kPoints = 5;
    const Eigen::Index m = kPoints * bodies;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * m, 6 * bodies);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(6 * bodies, 6 * bodies);
    Eigen::VectorXd v = Eigen::VectorXd::Zero(6 * bodies);
    for (Eigen::Index b = 0; b < bodies; ++b) {
      const double mass = std::pow(10.0, 0.5 * randomVector(random, 1)[0]);
      K.diagonal().segment<3>(6 * b).setConstant(1.0 / mass);
      K.diagonal().segment<3>(6 * b + 3).setConstant(600.0 / mass);
      v[6 * b + 2] = -0.1;
      for (Eigen::Index i = 0; i < kPoints; ++i) {
        const Eigen::Index c = kPoints * b + i;
        const Eigen::Vector3d n = (Eigen::Vector3d(0.0, 0.0, 2.0) + randomVector(random, 3)).normalized();
        const Eigen::Vector3d t = n.unitOrthogonal();
        const Eigen::Vector3d axes[3] = {n, t, n.cross(t)};
        const Eigen::Index row[3] = {c, m + 2 * c, m + 2 * c + 1};
        const Eigen::Index below = b - 1 - static_cast<Eigen::Index>(random() % 2);
        for (const auto& [body, sign] : {std::pair(b, 1.0), std::pair(below, -1.0)}) {
          if (body < 0) continue;
          const Eigen::Vector3d arm = 0.05 * (randomVector(random, 3) - sign * Eigen::Vector3d::UnitZ());
          for (int d = 0; d < 3; ++d) {
            J.block<1, 3>(row[d], 6 * body) = sign * axes[d].transpose();
            J.block<1, 3>(row[d], 6 * body + 3) = sign * arm.cross(axes[d]).transpose();
          }
        }
      }
    }
    D = J * K * J.transpose();
    const double compliance = 1e-10 * D.diagonal().mean();
    D.diagonal().array() += compliance;
    response.K = K;
    response.K_inverse = K.diagonal().cwiseInverse().asDiagonal();
    response.compliance = Eigen::VectorXd::Constant(3 * m, compliance);
    response.contacts.resize(m);
    for (Eigen::Index c = 0; c < m; ++c) {
      for (Eigen::Index first = 0; first < 6 * bodies; first += 6) {
        Eigen::Matrix<double, 3, 6> rows;
        rows << J.block<1, 6>(c, first), J.block<2, 6>(m + 2 * c, first);
        if (!rows.isZero(0.0)) response.contacts[c].of.emplace_back(first, rows);
      }
    }
    w0 = J * v;
    mu = Eigen::VectorXd::Constant(m, friction);
  }
};

TEST(FrictionalContact, HeapsOfFortyContactsObeyCoulombsLaw) {
  int alternated = 0;
  for (const double friction : {0.0, 0.2, 0.4}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const Heap heap(seed, 8, friction);
      const FrictionProblem problem{heap.D, heap.w0, heap.mu};
      SCOPED_TRACE(testing::Message() << "friction " << friction << ", seed " << seed);
      Eigen::VectorXd r;
      const FrictionReport report = solveFrictionalContact(problem, 1e-6, r);
      EXPECT_LT(report.residual, 1e-5);
      // Each is a factorisation or so; sweeps would be a thousand.
      EXPECT_LT(report.iterations, 200);
      Eigen::VectorXd by_bodies;
      const FrictionProblem known{heap.D, heap.w0, heap.mu, &heap.response};
      EXPECT_LT(solveFrictionalContact(known, 1e-6, by_bodies).residual, 1e-5);
      expectLaw(heap.D, heap.w0, heap.mu, by_bodies, 1e-4);
      expectLaw(heap.D, heap.w0, heap.mu, r, 1e-4);
      ClosestToLaw by_turns(problem, 1e-6 * heap.w0.cwiseAbs().maxCoeff());
      alternateProjections(problem, Eigen::VectorXd::Zero(3 * problem.count()), by_turns);
      alternated += by_turns.arrived();
      // What comes out is where the next step begins.
      Eigen::VectorXd again = r;
      if (report.solved) EXPECT_EQ(solveFrictionalContact(problem, 1e-6, again).iterations, 0);
    }
  }
  // Without friction it is one linear complementarity problem.
  EXPECT_GE(alternated, 10);
  EXPECT_LT(alternated, 25);
}

// Every third contact sticks, one slips and one does not take part.
TEST(ContactSystem, ByTheBodiesIsTheSameAsByTheContacts) {
  const Heap heap(3, 8, 0.5);
  const FrictionProblem problem{heap.D, heap.w0, heap.mu}, known{heap.D, heap.w0, heap.mu, &heap.response};
  std::mt19937 random(11);
  std::vector<Eigen::Index> contacts;
  std::vector<Eigen::Matrix3d> turn, own;
  for (Eigen::Index c = 0; c < heap.mu.size(); ++c) {
    if (c % 3 == 2) continue;
    contacts.push_back(c);
    turn.push_back(Eigen::Matrix3d::Identity());
    own.push_back(Eigen::Matrix3d::Zero());
    if (c % 3 == 0) continue;
    const Eigen::Vector2d along = randomVector(random, 2).normalized();
    const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - along * along.transpose();
    turn.back().bottomRightCorner<2, 2>() = 0.7 * across;
    own.back().bottomRightCorner<2, 2>() = problem.D(c, c) * (Eigen::Matrix2d::Identity() - 0.7 * across);
    own.back().bottomLeftCorner<2, 1>() = -0.5 * problem.D(c, c) * along;
  }
  const auto rows = static_cast<Eigen::Index>(3 * contacts.size());
  ASSERT_GT(rows, heap.response.K.rows());
  const ContactSystem dense(problem, contacts, turn, own), by_bodies(known, contacts, turn, own);
  for (int trial = 0; trial < 20; ++trial) {
    // What some impulses of size 1 do.
    const Eigen::VectorXd d = randomVector(random, rows);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(heap.w0.size()), b(rows);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (int e = 0; e < 3; ++e) r[problem.entry(contacts[i], e)] = d[static_cast<Eigen::Index>(3 * i) + e];
    }
    const Eigen::VectorXd w = heap.D * r;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Eigen::Index c = contacts[i], at = static_cast<Eigen::Index>(3 * i);
      const Eigen::Vector3d velocity(w[c], w[problem.entry(c, 1)], w[problem.entry(c, 2)]);
      b.segment<3>(at) = turn[i] * velocity + own[i] * d.segment<3>(at);
    }
    for (const ContactSystem* system : {&dense, &by_bodies}) {
      // Redundant contacts: velocities count.
      const Eigen::VectorXd wrong = system->solve(b) - d;
      Eigen::VectorXd r_wrong = Eigen::VectorXd::Zero(heap.w0.size());
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        for (int e = 0; e < 3; ++e)
          r_wrong[problem.entry(contacts[i], e)] = wrong[static_cast<Eigen::Index>(3 * i) + e];
      }
      EXPECT_LT((heap.D * r_wrong).norm(), 1e-10 * w.norm()) << (system == &dense ? "dense" : "by bodies");
    }
  }
}

// Normal and tangent coupled strongly, with so much friction that alternation may cycle: contact by contact the law is
// met, by slip in directions that only the search over all finds.
void expectSwept(const Eigen::MatrixXd& D, const Eigen::VectorXd& w0, const Eigen::VectorXd& mu) {
  const FrictionProblem problem{D, w0, mu};
  const double goal = 1e-10 * w0.cwiseAbs().maxCoeff();
  ClosestToLaw swept(problem, goal);
  sweepContacts(problem, Eigen::VectorXd::Zero(w0.size()), swept);
  ASSERT_TRUE(swept.arrived()) << swept.residual();
  const Eigen::VectorXd& r = swept.impulses();
  expectLaw(D, w0, mu, r, 1e-8);
  const Eigen::VectorXd w = D * r + w0;
  for (Eigen::Index c = 0; c < mu.size(); ++c) EXPECT_GT(w.segment<2>(mu.size() + 2 * c).norm(), 1e-2) << c;
  Eigen::VectorXd whole;
  EXPECT_TRUE(solveFrictionalContact(problem, 1e-10, whole).acceptable());
}

TEST(ContactSweeps, FindTheSlip) {
  Eigen::Matrix3d D;
  D << 3.5, 2.5, 1.0, 2.5, 2.75, 2.5, 1.0, 2.5, 4.5;
  expectSwept(D, Eigen::Vector3d(-2.0, -1.0, 1.5), Eigen::VectorXd::Constant(1, 4.0));
  D << 2.25, 1.0, 0.0, 1.0, 2.25, -3.25, 0.0, -3.25, 6.5;
  expectSwept(D, Eigen::Vector3d(-0.5, -1.0, 1.0), Eigen::VectorXd::Constant(1, 2.5));
}

TEST(ContactSweeps, CarryFromContactToContact) {
  Eigen::Matrix<double, 6, 6> D;
  D << 9.75, 1.5, 5.0, 1.5, 2.0, 2.25,    //
      1.5, 5.5, -3.0, 1.75, -6.0, 0.5,    //
      5.0, -3.0, 16.5, 5.75, 2.75, 2.75,  //
      1.5, 1.75, 5.75, 4.0, -3.25, 1.25,  //
      2.0, -6.0, 2.75, -3.25, 14.0, 1.75,  //
      2.25, 0.5, 2.75, 1.25, 1.75, 2.0;
  Eigen::Matrix<double, 6, 1> w0;
  w0 << -0.5, 0.0, -0.5, 0.0, 1.0, 0.0;
  expectSwept(D, w0, Eigen::Vector2d(4.0, 2.5));
}

}  // namespace
}  // namespace monolith
