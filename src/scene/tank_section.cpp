#include <cmath>
#include <sstream>

#include "scene/scene_memory.h"
#include "scene/scene_sections.h"
#include "scene/shown_vector.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

constexpr double kCellTolerance = 1e-6;  // of a cell
constexpr double kWidestCell = 1e9;      // m, and the inverse of the least: volumes and energies stay numbers
constexpr int kLeastCells = 4;           // along an axis
constexpr double kFarthestCells = 1e9;   // of the origin: beyond, a cell is lost in the round-off of positions
constexpr double kDensest = 1e9;         // kg/m^3
constexpr double kMostViscous = 1e15;    // Pa.s

char axisName(int axis) { return "xyz"[axis]; }

// Whether cells of the tank have their centres between `least` and `most`. Not on them: the surface is no liquid.
bool holdsCentre(const TankDescription& tank, const Vector3d& least, const Vector3d& most) {
  const auto cells = [&](const Vector3d& x) -> Eigen::Array3d {
    return (x - tank.origin).array() / tank.cell_width - 0.5;
  };
  return (cells(least).floor() + 1.0 < cells(most).ceil()).all();
}

// Sets the size to the whole number of cells it is within round-off of.
bool fitCells(const YamlMap& map, TankDescription& tank) {
  bool fits = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = tank.size[axis] / tank.cell_width;
    const double whole = std::round(cells);
    std::ostringstream text;
    if (!(std::abs(cells - whole) <= kCellTolerance)) {
      text << "a whole number of cells of " << tank.cell_width << " m along " << axisName(axis) << ": "
           << std::floor(cells) * tank.cell_width << " or " << std::ceil(cells) * tank.cell_width
           << " m are the nearest sizes that fit";
    } else if (whole < kLeastCells) {
      text << "at least " << kLeastCells << " cells of " << tank.cell_width << " m along " << axisName(axis)
           << ", not " << whole;
    }
    if (text.str().empty()) {
      tank.size[axis] = whole * tank.cell_width;
    } else {
      map.fail("size", text.str());
      fits = false;
    }
  }
  return fits;
}

}  // namespace

bool readTank(const YAML::Node& node, TankDescription& tank, Violations& violations) {
  const YamlMap map(node, "tank", {"size", "origin", "cell_width", "periodic"}, violations);
  const std::size_t violations_before = violations.count();
  map.require("size", "[x, y, z] in m");
  map.require("cell_width", "a width in m");
  map.read<3>("size", tank.size, Range::kPositive);
  map.read("cell_width", tank.cell_width, Range::kPositive);
  if (!(tank.cell_width >= 1.0 / kWidestCell && tank.cell_width <= kWidestCell)) {
    map.fail("cell_width", "from 1e-9 to 1e9 m");
  }
  map.read("periodic", tank.periodic);
  if (violations.count() > violations_before || !fitCells(map, tank)) return false;
  tank.origin = Vector3d(-0.5 * tank.size.x(), -0.5 * tank.size.y(), 0.0);
  map.read<3>("origin", tank.origin);
  if (!(tank.origin.cwiseAbs().maxCoeff() <= kFarthestCells * tank.cell_width)) {
    std::ostringstream text;
    text << "coordinates of at most " << kFarthestCells * tank.cell_width << " m, 1e9 cells";
    map.fail("origin", text.str());
  }
  return violations.count() == violations_before;
}

void checkMemory(const YAML::Node& node, const Scene& scene, double usable, Violations& violations) {
  const double gigabyte = 1e9;
  const double needed = neededMemory(scene);
  if (!(needed > usable)) return;
  std::ostringstream text;
  text << "tank.cell_width: value " << shownValue(node["cell_width"])
       << ": expected a tank that fits in memory: " << (scene.tank.size / scene.tank.cell_width).array().round().prod()
       << " cells need about " << needed / gigabyte << " GB by this solver, this machine or container has "
       << usable / gigabyte << " GB";
  violations.add(node["cell_width"], text.str());
}

void readLiquid(const YAML::Node& node, const TankDescription& tank, bool tank_usable, LiquidDescription& liquid,
                Violations& violations) {
  const YamlMap map(node, "liquid", {"density", "dynamic_viscosity", "rheology", "fill_level", "boxes"}, violations);
  map.read("density", liquid.density, Range::kPositive);
  if (!(liquid.density >= 1.0 / kDensest && liquid.density <= kDensest)) {
    map.fail("density", "from 1e-9 to 1e9 kg/m^3");
  }
  map.read("dynamic_viscosity", liquid.dynamic_viscosity, Range::kNotNegative);
  if (!(liquid.dynamic_viscosity <= kMostViscous)) map.fail("dynamic_viscosity", "at most 1e15 Pa.s");
  if (map.has("rheology")) readRheology(map.get("rheology"), liquid.rheology, violations);
  if (liquid.rheology.law != RheologyDescription::Law::kNewtonian && map.has("dynamic_viscosity")) {
    map.fail("dynamic_viscosity", "none, viscosity is that of liquid.rheology");
  }
  map.read("fill_level", liquid.fill_level, Range::kNotNegative);
  const double tolerance = kCellTolerance * tank.cell_width;
  if (tank_usable && liquid.fill_level > tank.size.z() + tolerance) {
    map.fail("fill_level", "at most the height of the tank, " + std::to_string(tank.size.z()) + " m");
  }
  if (tank_usable && liquid.fill_level > 0.0 && liquid.fill_level <= 0.5 * tank.cell_width) {
    map.fail("fill_level", "0, or more than half a cell, " + std::to_string(0.5 * tank.cell_width) + " m");
  }
  if (!map.has("boxes")) return;
  if (!map.get("boxes").IsSequence()) return map.fail("boxes", "a list of {min: [x, y, z], max: [x, y, z]}");
  const Eigen::AlignedBox3d inside(tank.origin - Vector3d::Constant(tolerance),
                                   tank.origin + tank.size + Vector3d::Constant(tolerance));
  const YAML::Node boxes = map.get("boxes");
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::string path = "liquid.boxes[" + std::to_string(i) + "]";
    const YamlMap box(boxes[i], path, {"min", "max"}, violations);
    box.require("min", "[x, y, z] in m");
    box.require("max", "[x, y, z] in m");
    const std::size_t violations_before = violations.count();
    Vector3d least = Vector3d::Zero(), most = Vector3d::Ones();
    box.read<3>("min", least);
    box.read<3>("max", most);
    if (!box.has("min") || !box.has("max") || violations.count() > violations_before) continue;
    if (!(least.array() < most.array()).all()) box.fail("max", "more than min along every axis");
    if (tank_usable && !(inside.contains(least) && inside.contains(most))) {
      std::ostringstream text;
      text << path << ": value " << shownValue(boxes[i]) << ": expected a box inside the tank, from "
           << shownVector(tank.origin) << " to " << shownVector(tank.origin + tank.size);
      violations.add(boxes[i], text.str());
    }
    if (tank_usable && violations.count() == violations_before && !holdsCentre(tank, least, most)) {
      std::ostringstream text;
      text << path << ": value " << shownValue(boxes[i])
           << ": expected a box that holds the centre of a cell, of which "
           << "the width is " << tank.cell_width << " m";
      violations.add(boxes[i], text.str());
    }
    liquid.boxes.emplace_back(least, most);
  }
}

void readSolver(const YAML::Node& node, SolverDescription& solver, Violations& violations) {
  const YamlMap map(
      node, "solver",
      {"name", "coupling", "discretisation", "time_stepping", "tolerance", "maximum_iterations", "threads", "cfl"},
      violations);
  const std::string name = map.readWord("name", "fast", {"fast", "direct", "reference"});
  solver.name = name == "direct"      ? SolverName::kDirect
                : name == "reference" ? SolverName::kReference
                                      : SolverName::kFast;
  if (map.readWord("coupling", "unified", {"unified", "iterative"}) == "iterative") {
    solver.coupling = CouplingName::kIterative;
  }
  if (map.readWord("discretisation", "fitted", {"fitted", "fractions"}) == "fractions") {
    solver.discretisation = Discretisation::kFractions;
  }
  if (map.readWord("time_stepping", "bdf2", {"backward_euler", "bdf2"}) == "backward_euler") {
    solver.time_stepping = TimeStepping::kBackwardEuler;
  }
  map.read("tolerance", solver.tolerance, Range::kPositive);
  if (!(solver.tolerance >= kLeastTolerance && solver.tolerance < 1.0)) {
    map.fail("tolerance", "a relative residual of at least 1e-12, round-off, and below 1");
  }
  map.read("maximum_iterations", solver.maximum_iterations, 1);
  map.read("threads", solver.threads, 0, kMostThreads);
  map.read("cfl", solver.cfl, Range::kPositive);
}

}  // namespace monolith
