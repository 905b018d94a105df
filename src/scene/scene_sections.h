#pragma once
// The parts of a scene file, each read from its own map. What is wrong is added to the violations.

#include <string>
#include <vector>

#include "scene/scene_file.h"
#include "scene/yaml_map.h"

namespace monolith {

// Returns whether the tank is usable, so that what depends on it can be checked.
bool readTank(const YAML::Node& node, TankDescription& tank, Violations& violations);

// node: the tank's. usable: bytes.
void checkMemory(const YAML::Node& node, const Scene& scene, double usable, Violations& violations);

void readLiquid(const YAML::Node& node, const TankDescription& tank, bool tank_usable, LiquidDescription& liquid,
                Violations& violations);

// After the bodies, whose names and materials it refers to.
void readContact(const YAML::Node& node, const std::vector<BodyDescription>& bodies, ContactDescription& contact,
                 Violations& violations);

void readRheology(const YAML::Node& node, RheologyDescription& rheology, Violations& violations);
void readSolver(const YAML::Node& node, SolverDescription& solver, Violations& violations);

// Entry `index` of the list of bodies: that of the URDF's root link and those beyond its joints, which become
// Scene::bodies from `first` on. `folder` is that of the scene file.
std::vector<BodyDescription> readBody(const YAML::Node& node, int index, int first, const std::string& folder,
                                      const SceneResolver& resolver, Violations& violations);

// self_collision and joints of an entry of the list of bodies; `bodies` are those of its URDF.
void readJoints(const YamlMap& map, std::vector<BodyDescription>& bodies, Violations& violations);

// All shapes must lie inside the walls; along a periodic axis they must be shorter than the period.
void checkInsideTank(const BodyDescription& body, const YAML::Node& node, const TankDescription& tank,
                     Violations& violations);

}  // namespace monolith
