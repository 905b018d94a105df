// The scene's liquid.rheology section: each law's keys, and what is wrong with them.

#include <gtest/gtest.h>

#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

using Law = RheologyDescription::Law;

class RheologySection : public testing::Test {
 protected:
  Scene load(const std::string& rheology, const std::string& viscosity = "") const {
    return loadScene(folder_.write("scene.yaml",
                                   "tank: {size: [1.0, 0.8, 0.6], cell_width: 0.1}\n"
                                   "liquid: {fill_level: 0.3, " +
                                       viscosity + "rheology: " + rheology + "}\n"),
                     SceneResolver());
  }
  std::string errorOf(const std::string& rheology, const std::string& viscosity = "") const {
    try {
      load(rheology, viscosity);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "no error";
  }
  void expectError(const std::string& rheology, const std::vector<std::string>& parts) const {
    const std::string error = errorOf(rheology);
    EXPECT_NE(error.find("scene.yaml"), std::string::npos) << error;
    for (const std::string& part : parts) EXPECT_NE(error.find(part), std::string::npos) << part << " in: " << error;
  }

  TemporaryFolder folder_;
};

TEST_F(RheologySection, DefaultIsNewtonian) {
  EXPECT_EQ(load("{law: newtonian}", "dynamic_viscosity: 2.0, ").liquid.rheology.law, Law::kNewtonian);
}

TEST_F(RheologySection, ReadsEachLaw) {
  const RheologyDescription power =
      load("{law: power_law, consistency: 3, index: 0.5, minimum_viscosity: 0.01, maximum_viscosity: 100}")
          .liquid.rheology;
  EXPECT_EQ(power.law, Law::kPowerLaw);
  EXPECT_EQ(power.consistency, 3.0);
  EXPECT_EQ(power.index, 0.5);
  EXPECT_EQ(power.minimum_viscosity, 0.01);
  EXPECT_EQ(power.maximum_viscosity, 100.0);

  const RheologyDescription carreau =
      load(
          "{law: carreau_yasuda, zero_shear_viscosity: 8, infinite_shear_viscosity: 0.1, time_constant: 2, index: 0.3, "
          "transition: 1.5, maximum_iterations: 7}")
          .liquid.rheology;
  EXPECT_EQ(carreau.law, Law::kCarreauYasuda);
  EXPECT_EQ(carreau.zero_shear_viscosity, 8.0);
  EXPECT_EQ(carreau.infinite_shear_viscosity, 0.1);
  EXPECT_EQ(carreau.time_constant, 2.0);
  EXPECT_EQ(carreau.transition, 1.5);
  EXPECT_EQ(carreau.maximum_iterations, 7);

  // Bingham needs no limits: its own are K and K + m tau_0.
  const RheologyDescription bingham =
      load("{law: herschel_bulkley, yield_stress: 12, consistency: 1, regularisation: 100}").liquid.rheology;
  EXPECT_EQ(bingham.law, Law::kHerschelBulkley);
  EXPECT_EQ(bingham.yield_stress, 12.0);
  EXPECT_EQ(bingham.index, 1.0);
  EXPECT_EQ(bingham.regularisation, 100.0);
}

TEST_F(RheologySection, NamesWhatIsWrong) {
  expectError("{law: toothpaste}", {"liquid.rheology.law", "toothpaste", "herschel_bulkley"});
  expectError("{consistency: 3}", {"liquid.rheology", "law"});
  expectError("{law: power_law, index: 0.5, minimum_viscosity: 1, maximum_viscosity: 2}", {"consistency", "Pa s^n"});
  expectError("{law: power_law, consistency: -3, index: 0.5, minimum_viscosity: 1, maximum_viscosity: 2}",
              {"liquid.rheology.consistency", "-3"});
  expectError("{law: power_law, consistency: 3, index: 0.5}", {"minimum_viscosity", "unbounded"});
  expectError("{law: power_law, consistency: 3, index: 0.5, minimum_viscosity: 2, maximum_viscosity: 1}",
              {"maximum_viscosity", "at least minimum_viscosity"});
  expectError(
      "{law: carreau_yasuda, zero_shear_viscosity: 1, infinite_shear_viscosity: 2, time_constant: 1, index: 0.5}",
      {"infinite_shear_viscosity", "at most zero_shear_viscosity"});
  expectError("{law: carreau_yasuda, zero_shear_viscosity: 1, time_constant: 1, index: 1.5}", {"index", "at most 1"});
  expectError("{law: herschel_bulkley, yield_stress: .nan, consistency: 1, regularisation: 100}", {"yield_stress"});
  // A key of another law is unknown here, with the nearest one that is known.
  expectError("{law: carreau_yasuda, zero_shear_viscosity: 1, time_constant: 1, index: 0.5, yield_stress: 3}",
              {"yield_stress"});
  expectError("{law: power_law, consistancy: 3, index: 0.5, minimum_viscosity: 1, maximum_viscosity: 2}",
              {"consistancy", "consistency"});
}

TEST_F(RheologySection, ContradictsAConstantViscosity) {
  const std::string error = errorOf("{law: herschel_bulkley, yield_stress: 12, consistency: 1, regularisation: 100}",
                                    "dynamic_viscosity: 2.0, ");
  EXPECT_NE(error.find("dynamic_viscosity"), std::string::npos) << error;
}

// Without limits of its own a Bingham liquid has those of the law.
TEST_F(RheologySection, ABinghamLiquidsLimitsAreHeldAgainstThoseOfTheLaw) {
  const std::string law = "{law: herschel_bulkley, yield_stress: 2, consistency: 10, regularisation: 5, ";
  expectError(law + "maximum_viscosity: 5}", {"maximum_viscosity", "at least consistency"});
  expectError(law + "minimum_viscosity: 30}", {"minimum_viscosity", "at most consistency + regularisation"});
  EXPECT_EQ(load(law + "maximum_viscosity: 15}").liquid.rheology.maximum_viscosity, 15.0);
}

}  // namespace
}  // namespace monolith
