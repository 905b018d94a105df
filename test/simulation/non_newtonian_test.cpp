// Liquids whose viscosity depends on the shear rate, through whole simulations.

#include <gtest/gtest.h>

#include <cmath>

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {
namespace {

using Law = RheologyDescription::Law;

RheologyDescription powerLaw(double consistency, double index) {
  RheologyDescription r;
  r.law = Law::kPowerLaw;
  r.consistency = consistency;
  r.index = index;
  r.minimum_viscosity = 1e-4;
  r.maximum_viscosity = 1e4;
  return r;
}

RheologyDescription bingham(double yield_stress, double consistency = 2.0) {
  RheologyDescription r;
  r.law = Law::kHerschelBulkley;
  r.yield_stress = yield_stress;
  r.consistency = consistency;
  r.regularisation = 1000.0;
  return r;
}

// Plates 0.1 m apart, liquid of 1000 kg/m^3 driven along them by 1 m/s^2; a step of time is as good as steady.
double channelMean(const RheologyDescription& rheology, int cells) {
  const double width = 0.1;
  Scene scene;
  scene.source = "test";
  scene.tank.cell_width = width / cells;
  scene.tank.size = {4.0 * scene.tank.cell_width, 4.0 * scene.tank.cell_width, width};
  scene.tank.periodic[0] = scene.tank.periodic[1] = true;
  scene.liquid.rheology = rheology;
  scene.liquid.fill_level = width;
  scene.gravity = {1.0, 0.0, 0.0};
  scene.time_step = 1000.0;
  scene.solver.cfl = 1e12;
  scene.solver.tolerance = 1e-6;
  Simulation simulation(scene);
  double mean = 0.0;
  for (int i = 0; i < 3; ++i) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
    EXPECT_GT(r.rheology_iterations, 0);
    mean = r.liquid_momentum[0] / (1000.0 * scene.tank.size.prod());
  }
  return mean;
}

// Bird, Armstrong & Hassager 1987, Dynamics of Polymeric Liquids 1, 4.2: mean velocity between plates 2 B apart,
//   (tau_w/K)^(1/n) B / (1/n + 2).
TEST(NonNewtonian, PlaneChannelOfAPowerLawLiquidConvergesToTheExactFlow) {
  const double wall_stress = 50.0, half = 0.05;
  for (const auto& [K, n] : {std::pair(10.0, 0.5), std::pair(0.5, 1.5)}) {
    const double exact = std::pow(wall_stress / K, 1.0 / n) * half / (1.0 / n + 2.0);
    const double coarse = channelMean(powerLaw(K, n), 8) / exact - 1.0;
    const double fine = channelMean(powerLaw(K, n), 16) / exact - 1.0;
    EXPECT_LT(std::abs(fine), 0.02) << n;
    EXPECT_GT(std::log2(std::abs(coarse / fine)), 1.8) << n << ": errors " << coarse << ", " << fine;
  }
}

// Bird et al. 1987, 4.2: with phi = tau_0/tau_w, mean = tau_w B/(3 K) (1 - 3/2 phi + 1/2 phi^3).
TEST(NonNewtonian, BinghamLiquidFlowsAsAPlugOrNotAtAll) {
  const double phi = 20.0 / 50.0;
  const double exact = 50.0 * 0.05 / (3.0 * 2.0) * (1.0 - 1.5 * phi + 0.5 * phi * phi * phi);
  EXPECT_NEAR(channelMean(bingham(20.0), 16) / exact, 1.0, 0.03);
  // The walls' 50 Pa do not make it yield: it creeps with the viscosity that regularises it.
  const double creep = 50.0 * 0.05 / 3.0 / (2.0 + 1000.0 * 60.0);
  EXPECT_LT(channelMean(bingham(60.0), 16), 3.0 * creep);
}

// The iteration may lead to viscosities that are too hard to solve for, and has done so for these: then it goes on from
// better ones.
TEST(NonNewtonian, ABinghamLiquidSettlesWhateverItsConsistency) {
  const double phi = 20.0 / 50.0;
  for (const double consistency : {2.001, 2.009, 2.011, 2.012}) {
    const double exact = 50.0 * 0.05 / (3.0 * consistency) * (1.0 - 1.5 * phi + 0.5 * phi * phi * phi);
    EXPECT_NEAR(channelMean(bingham(20.0, consistency), 16) / exact, 1.0, 0.03) << consistency;
  }
}

Scene ballInATank(double viscosity) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = Eigen::Vector3d::Constant(0.12);
  scene.tank.cell_width = 0.01;
  scene.liquid.dynamic_viscosity = viscosity;
  scene.liquid.fill_level = 0.09;
  scene.time_step = 0.005;
  scene.contact.friction = 0.3;
  scene.bodies = {sphereBody("ball", 0.02, 4000.0, {0.055, 0.06, 0.045}),
                  boxBody("box", {0.05, 0.04, 0.03}, 600.0, {0.06, 0.065, 0.085})};
  scene.solver.tolerance = 1e-8;
  return scene;
}

std::vector<Vector6d> twistsAfter(const Scene& scene, int steps) {
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) {
    const StepReport r = simulation.step();
    EXPECT_TRUE(r.committed()) << r.message;
  }
  std::vector<Vector6d> out;
  for (const RigidBody& body : simulation.bodies()) out.push_back(body.twist);
  return out;
}

TEST(NonNewtonian, PowerLawOfIndexOneIsNewtonian) {
  for (const Discretisation d : {Discretisation::kFitted, Discretisation::kFractions}) {
    Scene constant = ballInATank(3.0);
    constant.solver.discretisation = d;
    Scene law = constant;
    law.liquid.rheology = powerLaw(3.0, 1.0);
    const auto a = twistsAfter(constant, 4);
    const auto b = twistsAfter(law, 4);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_GT(a[i].norm(), 1e-3);
      EXPECT_LT((a[i] - b[i]).norm(), 1e-5 * a[i].norm());
    }
  }
}

TEST(NonNewtonian, ThickeningLiquidHoldsABallBackMoreThanAThinningOne) {
  const auto speed = [](double index) {
    Scene scene = ballInATank(0.0);
    scene.solver.tolerance = 1e-6;
    scene.liquid.rheology = powerLaw(1.0, index);
    return -twistsAfter(scene, 8)[0][2];
  };
  // Rates are above 1/s, so the viscosity is below and above 1 Pa s.
  const double thinning = speed(0.5), newtonian = speed(1.0), thickening = speed(1.4);
  EXPECT_GT(thinning, 1.05 * newtonian);
  EXPECT_GT(newtonian, 1.05 * thickening);
  EXPECT_GT(thickening, 0.0);
}

// Below Y_G = tau_0/(g d (rho_s - rho)) = 0.143/3 a sphere sinks, above it is held (Beris, Tsamopoulos, Armstrong &
// Brown 1985, J. Fluid Mech. 158, 219: 0.0477 = 0.143/3 in these units).
TEST(NonNewtonian, YieldStressHoldsABallUp) {
  const double weight = 9.81 * 0.04 * 1000.0;  // g d (rho_s - rho), Pa
  const auto speed = [&](double yield_number) {
    Scene scene = ballInATank(0.0);
    scene.bodies = {sphereBody("ball", 0.02, 2000.0, {0.06, 0.06, 0.06})};
    scene.liquid.fill_level = 0.12;
    scene.solver.tolerance = 1e-5;
    scene.time_step = 0.05;
    scene.liquid.rheology = bingham(yield_number * weight);
    return -twistsAfter(scene, 4)[0][2];
  };
  const double sinking = speed(0.01), held = speed(0.2);
  EXPECT_GT(sinking, 0.02);
  EXPECT_LT(held, 1e-2 * sinking);
  EXPECT_GT(held, 0.0);
}

TEST(NonNewtonian, ThreadsDoNotChangeABit) {
  Scene scene = ballInATank(0.0);
  scene.liquid.rheology = powerLaw(2.0, 0.6);
  scene.solver.tolerance = 1e-6;
  scene.solver.threads = 1;
  const auto one = twistsAfter(scene, 2);
  scene.solver.threads = 2;
  const auto two = twistsAfter(scene, 2);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(one[i] == two[i]);
}

TEST(NonNewtonian, AViscosityThatDoesNotSettleIsReportedAndNotCommitted) {
  Scene scene = ballInATank(0.0);
  scene.liquid.rheology = powerLaw(2.0, 0.3);
  scene.liquid.rheology.maximum_iterations = 1;
  Simulation simulation(scene);
  const Eigen::Vector3d before = simulation.bodyStates()[0].X_WB.translation();
  const StepReport r = simulation.step();
  EXPECT_FALSE(r.committed());
  EXPECT_NE(r.message.find("viscosity did not settle"), std::string::npos) << r.message;
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_TRUE(simulation.bodyStates()[0].X_WB.translation() == before);
}

}  // namespace
}  // namespace monolith
