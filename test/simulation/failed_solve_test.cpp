// A step that a solver other than `fast`, or a coupling, does not solve is reported, by what went wrong, and not
// committed.

#include <gtest/gtest.h>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

struct Way {
  const char* name;
  SolverName solver;
  CouplingName coupling;
  const char* message;
};

void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

class FailedSolve : public ::testing::TestWithParam<Way> {
 protected:
  // A box on the floor of a tank of so few cells that even `reference` soon gives up.
  static Scene scene() {
    Scene scene;
    scene.source = "test";
    scene.tank.size = Eigen::Vector3d::Constant(0.16);
    scene.tank.cell_width = 0.04;
    scene.liquid.fill_level = 0.1;
    scene.contact.friction = 0.3;
    scene.solver.name = GetParam().solver;
    scene.solver.coupling = GetParam().coupling;
    scene.solver.threads = 1;
    scene.bodies.push_back(boxBody("box", {0.07, 0.05, 0.04}, 2000.0, {0.08, 0.08, 0.02}));
    return scene;
  }
};

TEST_P(FailedSolve, IsReportedAndNotCommitted) {
  Scene beyond_reach = scene();
  beyond_reach.solver.tolerance = 1e-18;
  Simulation simulation(beyond_reach);
  const BodyState before = simulation.bodyStates()[0];
  const Eigen::Vector3d below(0.03, 0.05, 0.03);
  const double energy = simulation.report().potential_energy;
  const StepReport r = simulation.step();
  EXPECT_FALSE(r.committed());
  EXPECT_EQ(r.status, SolveStatus::kNotConverged);
  EXPECT_NE(r.message.find(GetParam().message), std::string::npos) << r.message;
  EXPECT_NE(r.message.find("wanted 1e-18"), std::string::npos) << r.message;
  EXPECT_GT(r.residual, 1e-18);
  EXPECT_GT(r.retries, 0);
  EXPECT_EQ(r.step, 0);
  EXPECT_EQ(r.time, 0.0);
  EXPECT_EQ(r.potential_energy, energy);
  EXPECT_EQ(simulation.time(), 0.0);
  const BodyState after = simulation.bodyStates()[0];
  EXPECT_EQ(after.X_WB.matrix(), before.X_WB.matrix());
  EXPECT_EQ(after.velocity, before.velocity);
  EXPECT_EQ(after.liquid.force, before.liquid.force);
  EXPECT_EQ(after.contact.force, before.contact.force);
  EXPECT_EQ(simulation.liquidVelocity(below), Eigen::Vector3d::Zero());
}

TEST_P(FailedSolve, IsNoneAtATolerableTolerance) {
  Simulation simulation(scene());
  const StepReport r = simulation.step();
  EXPECT_TRUE(r.committed()) << r.message;
  EXPECT_EQ(r.message, "");
  EXPECT_LE(r.residual, scene().solver.tolerance);
}

INSTANTIATE_TEST_SUITE_P(
    Ways, FailedSolve,
    ::testing::Values(Way{"direct", SolverName::kDirect, CouplingName::kUnified, "the direct solve reached"},
                      Way{"reference", SolverName::kReference, CouplingName::kUnified, "MPRGP stopped"},
                      Way{"iterative", SolverName::kDirect, CouplingName::kIterative, "the direct solve reached"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace monolith
