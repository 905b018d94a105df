#include "scene/scene_sections.h"

namespace monolith {
namespace {

using Law = RheologyDescription::Law;

// Least and largest viscosity; needed where the law itself is unbounded.
void readLimits(const YamlMap& map, bool needed, RheologyDescription& rheology) {
  if (needed) {
    map.require("minimum_viscosity", "a least viscosity in Pa s, since that of this law is unbounded");
    map.require("maximum_viscosity", "a largest viscosity in Pa s, since that of this law is unbounded");
  }
  map.read("minimum_viscosity", rheology.minimum_viscosity, Range::kPositive);
  map.read("maximum_viscosity", rheology.maximum_viscosity, Range::kPositive);
  if (rheology.maximum_viscosity > 0.0 && rheology.maximum_viscosity < rheology.minimum_viscosity) {
    map.fail("maximum_viscosity", "at least minimum_viscosity");
  }
}

void readPowerLaw(const YamlMap& map, RheologyDescription& rheology) {
  map.require("consistency", "K in Pa s^n");
  map.require("index", "n");
  map.read("consistency", rheology.consistency, Range::kPositive);
  map.read("index", rheology.index, Range::kPositive);
  readLimits(map, true, rheology);
}

void readCarreauYasuda(const YamlMap& map, RheologyDescription& rheology) {
  map.require("zero_shear_viscosity", "a viscosity in Pa s");
  map.require("time_constant", "lambda in s");
  map.require("index", "n");
  map.read("zero_shear_viscosity", rheology.zero_shear_viscosity, Range::kPositive);
  map.read("infinite_shear_viscosity", rheology.infinite_shear_viscosity, Range::kNotNegative);
  map.read("time_constant", rheology.time_constant, Range::kPositive);
  map.read("index", rheology.index, Range::kPositive);
  map.read("transition", rheology.transition, Range::kPositive);
  if (rheology.index > 1.0) map.fail("index", "at most 1: this law thins from one viscosity to another");
  if (rheology.infinite_shear_viscosity > rheology.zero_shear_viscosity) {
    map.fail("infinite_shear_viscosity", "at most zero_shear_viscosity");
  }
}

void readHerschelBulkley(const YamlMap& map, RheologyDescription& rheology) {
  map.require("yield_stress", "tau_0 in Pa");
  map.require("consistency", "K in Pa s^n");
  map.require("regularisation", "m in s");
  map.read("yield_stress", rheology.yield_stress, Range::kPositive);
  map.read("consistency", rheology.consistency, Range::kPositive);
  map.read("index", rheology.index, Range::kPositive);
  map.read("regularisation", rheology.regularisation, Range::kPositive);
  readLimits(map, rheology.index != 1.0, rheology);
  if (rheology.index != 1.0) return;
  // The law's own limits stand for those that are not given.
  const double most = rheology.consistency + rheology.regularisation * rheology.yield_stress;
  if (rheology.maximum_viscosity > 0.0 && rheology.minimum_viscosity <= 0.0 &&
      rheology.maximum_viscosity < rheology.consistency) {
    map.fail("maximum_viscosity", "at least consistency, the least viscosity of this law");
  }
  if (rheology.minimum_viscosity > most && rheology.maximum_viscosity <= 0.0) {
    map.fail("minimum_viscosity",
             "at most consistency + regularisation * yield_stress, the largest viscosity of this law");
  }
}

}  // namespace

void readRheology(const YAML::Node& node, RheologyDescription& rheology, Violations& violations) {
  const std::vector<std::string> laws = {"newtonian", "power_law", "carreau_yasuda", "herschel_bulkley"};
  // The keys depend on the law; which one it is, is read and judged below.
  const YAML::Node& constant = node;
  const std::string word = node.IsMap() && constant["law"].IsDefined() ? shownValue(constant["law"]) : "";
  std::vector<std::string> keys = {"law", "maximum_iterations"};
  const auto allow = [&](const std::vector<std::string>& more) { keys.insert(keys.end(), more.begin(), more.end()); };
  if (word == "power_law") allow({"consistency", "index", "minimum_viscosity", "maximum_viscosity"});
  if (word == "carreau_yasuda") {
    allow({"zero_shear_viscosity", "infinite_shear_viscosity", "time_constant", "index", "transition"});
  }
  if (word == "herschel_bulkley") {
    allow({"yield_stress", "consistency", "index", "regularisation", "minimum_viscosity", "maximum_viscosity"});
  }
  const YamlMap map(node, "liquid.rheology", keys, violations);
  map.require("law", "newtonian, power_law, carreau_yasuda or herschel_bulkley");
  const std::string law = map.readWord("law", laws.front(), laws);
  map.read("maximum_iterations", rheology.maximum_iterations, 1);
  if (law == "power_law") {
    rheology.law = Law::kPowerLaw;
    readPowerLaw(map, rheology);
  } else if (law == "carreau_yasuda") {
    rheology.law = Law::kCarreauYasuda;
    readCarreauYasuda(map, rheology);
  } else if (law == "herschel_bulkley") {
    rheology.law = Law::kHerschelBulkley;
    readHerschelBulkley(map, rheology);
  }
}

}  // namespace monolith
