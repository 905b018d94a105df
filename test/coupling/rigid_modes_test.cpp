// Liquid that nothing holds moves with its bodies as one: which liquid that is, the coarse level for it, and what it
// saves the solve.

#include "coupling/rigid_modes.h"

#include <gtest/gtest.h>

#include <random>

#include "coupling/fast_solver.h"
#include "scene/solid_body.h"

namespace monolith {
namespace {

constexpr int kCells = 16;

// A unit box with up to two spheres; the liquid within half a `width` of where they are.
struct DriftScene {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;

  DriftScene(double number, double width, int spheres, bool free, const std::array<bool, 3>& periodic = {})
      : grid(makeGrid(periodic)), problem(grid) {
    const double dt = 0.01;
    const std::vector<Eigen::Vector3d> centres = {{0.26, 0.51, 0.55}, {0.73, 0.47, 0.5}};
    for (int b = 0; b < spheres; ++b) {
      BodyDescription body = sphereBody("sphere" + std::to_string(b), 0.11, 1500.0, centres[b]);
      if (!free) body.motion = BodyMotion::kFixed;
      bodies.push_back(makeRigidBody(body, 0.5 * grid.h));
    }
    SolidSampler(grid).sample(bodies, solids);
    const Lattice& l = grid.lattice;
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < kCells; ++k) {
      for (int j = 0; j < kCells; ++j) {
        for (int i = 0; i < kCells; ++i) {
          const Eigen::Vector3d x = grid.cellCenter(i, j, k);
          double d = 1e3;
          for (int b = 0; b < std::max(spheres, 1); ++b)
            d = std::min(d, (x - centres[b]).cwiseAbs().maxCoeff() - 0.5 * width);
          liquid[l.index(i, j, k)] = d / grid.h;
        }
      }
    }
    extendIntoHalo(l, liquid);
    problem.assemble(solids, bodies, liquid, 1000.0, number * 1000.0 * grid.h * grid.h / dt, dt);
  }
  static MacGrid makeGrid(const std::array<bool, 3>& periodic) {
    MacGrid g;
    g.lattice = Lattice({kCells, kCells, kCells}, periodic);
    g.h = 1.0 / kCells;
    return g;
  }
  int adrift() const {
    int count = 0;
    for (const PressureRegion& region : problem.regions) count = std::max(count, region.drift + 1);
    return count;
  }
  // Of a solve under gravity.
  CoupledReport fall(double tolerance) {
    const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
    FaceField<double> velocity;
    for (int a = 0; a < 3; ++a) velocity[a].assign(grid.lattice.size, problem.dt * gravity[a]);
    std::vector<Vector6d> twists;
    for (RigidBody& body : bodies) {
      body.twist << 0.1, -0.2, 0.3, 0.5, 0.2, -0.4;
      twists.push_back(freeTwist(body, gravity, Wrench(), problem.dt));
    }
    StepVector rhs, x;
    EXPECT_EQ(problem.rightSide(velocity, twists, gravity, rhs), "");
    x.resize(grid.lattice, bodies.size());
    FastSolver fast;
    fast.prepare(problem);
    CoupledOptions options;
    options.tolerance = tolerance;
    return fast.solve(rhs, options, x);
  }
};

TEST(RigidModes, LiquidIsAdriftThatLittleHolds) {
  EXPECT_EQ(DriftScene(100.0, 0.4, 0, true).adrift(), 1);
  EXPECT_EQ(DriftScene(100.0, 0.4, 1, true).adrift(), 1);
  EXPECT_EQ(DriftScene(100.0, 0.4, 2, true).adrift(), 2);
  EXPECT_EQ(DriftScene(100.0, 0.4, 1, false).adrift(), 0) << "the body does not move";
  EXPECT_EQ(DriftScene(100.0, 9.0, 1, true).adrift(), 0) << "the tank is full";
  EXPECT_EQ(DriftScene(100.0, 9.0, 1, true, {true, true, true}).adrift(), 1) << "it has no walls";
}

// A pocket of liquid beside a body in a pool does not drift: the body is held, and it with that.
TEST(RigidModes, WhatABodyJoinsToLiquidThatIsHeldIsHeld) {
  const Lattice l({8, 8, 8}, {false, false, false});
  StaggeredCoefficients<double> c;
  c.resize(l, true);
  const auto pocket = l.index(4, 4, 6);
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 8; ++i) c.has_pressure[l.index(i, j, k)] = 1;
    }
  }
  c.has_pressure[pocket] = 1;
  for (int a = 0; a < 3; ++a) {
    for (std::size_t f = 0; f < l.size; ++f) c.mass[a][f] = c.own_fluid[a][f] = 1.0;
  }
  BodyRows rows;
  rows.divergence.push_back({pocket, 0, Vector6d::Unit(2)});
  BodyCoordinates one_body;
  one_body.set({RigidBody()});
  const auto adrift = [&] {
    int count = 0;
    for (const PressureRegion& region : findPressureRegions(c, rows, one_body)) count += region.drift >= 0;
    return count;
  };
  EXPECT_EQ(adrift(), 1);
  rows.divergence.push_back({l.index(4, 4, 3), 0, Vector6d::Unit(2)});
  EXPECT_EQ(adrift(), 0);
}

TEST(RigidModes, ThinLiquidNeedsNone) {
  const DriftScene thin(1.0, 0.4, 1, true);
  RigidModes modes;
  modes.set(thin.problem, Eigen::VectorXd::Ones(6), [](auto&, auto&) { FAIL(); });
  EXPECT_EQ(modes.drifts(), 0);
}

// On an operator that is any positive diagonal: what it finds is the whole common motion, and nothing else.
TEST(RigidModes, CorrectionTakesTheCommonMotionOut) {
  for (const bool endless : {false, true}) {
    const DriftScene drift(100.0, endless ? 9.0 : 0.4, 2, true, {endless, endless, endless});
    const Lattice& l = drift.grid.lattice;
    const std::size_t size = 4 * l.size + 12;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.5, 1.5);
    std::vector<double> diagonal(size);
    for (double& d : diagonal) d = unit(random);
    const auto apply = [&](std::vector<double>& x, std::vector<double>& y) {
      for (std::size_t i = 0; i < size; ++i) y[i] = diagonal[i] * x[i];
    };
    RigidModes modes;
    modes.set(drift.problem, Eigen::VectorXd::LinSpaced(12, 0.5, 2.0), apply);
    ASSERT_EQ(modes.drifts(), endless ? 1 : 2);
    std::vector<float> r(size), z(size, 0.0f), again(size, 0.0f), rest(size, 0.0f);
    for (float& value : r) value = static_cast<float>(unit(random) - 0.9);
    modes.correct(r, z);
    std::vector<float> Az(size), left(size);
    for (std::size_t i = 0; i < size; ++i) {
      Az[i] = static_cast<float>(diagonal[i] * z[i]);
      left[i] = r[i] - Az[i];
    }
    modes.correct(Az, again);
    modes.correct(left, rest);
    double length = 0.0, change = 0.0, remainder = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      length = std::max<double>(length, std::abs(z[i]));
      change = std::max<double>(change, std::abs(again[i] - z[i]));
      remainder = std::max<double>(remainder, std::abs(rest[i]));
    }
    EXPECT_GT(length, 1e-3);
    EXPECT_LT(change, 1e-4 * length);
    EXPECT_LT(remainder, 1e-4 * length);
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < l.size; ++f) {
        if (!(drift.problem.coefficients.mass[a][f] > 0.0)) EXPECT_EQ(z[a * l.size + f], 0.0f);
      }
    }
    for (std::size_t c = 3 * l.size; c < 4 * l.size; ++c) EXPECT_EQ(z[c], 0.0f) << "no pressure";
  }
}

// Without the modes it takes up to 160 where there is no body, and more than 200 with one at a viscous number of 2500.
TEST(RigidModes, AFallingBlobIsSolvedWhateverItsViscosity) {
  for (const double number : {100.0, 2500.0, 1e5}) {
    DriftScene blob(number, 0.4, 0, true);
    EXPECT_LE(blob.fall(1e-4).iterations, 5) << number;
  }
  for (const double number : {100.0, 2500.0}) {
    const CoupledReport report = DriftScene(number, 0.4, 1, true).fall(1e-4);
    EXPECT_EQ(report.status, SolveStatus::kConverged) << report.message;
    EXPECT_LT(report.iterations, 50) << number;
  }
}

}  // namespace
}  // namespace monolith
