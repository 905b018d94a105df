#include "scene/scene_memory.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace monolith {
namespace {

namespace fs = std::filesystem;

// At the peak of a step, viscous, one body: ./tank bench. What `direct` and `reference` take beside it for each cell of
// liquid, with viscosity and without, of up to 28^3 cells; a factor's grows with the cells along an axis, of viscous
// `direct` measured to 16^3.
constexpr double kBytesPerCell = 1700.0;
constexpr double kViscousSystemBytes = 11000.0, kFactorBytes = 1400.0, kInviscidFactorBytes = 2000.0;

// Of a group and those that it lies in, down from `folder`. A file that says "max" is no limit.
double limitAlong(fs::path folder, const fs::path& group, const char* file) {
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&] {
    double bytes = 0.0;
    if (std::ifstream(folder / file) >> bytes) least = std::min(least, bytes);
  };
  look();
  for (const fs::path& name : group.relative_path()) {
    folder /= name;
    look();
  }
  return least;
}

}  // namespace

double neededMemory(const Scene& scene) {
  const TankDescription& tank = scene.tank;
  const LiquidDescription& liquid = scene.liquid;
  const double cells = (tank.size / tank.cell_width).array().round().prod();
  double volume = liquid.fill_level * tank.size.x() * tank.size.y();
  for (const Eigen::AlignedBox3d& box : liquid.boxes) volume += box.volume();
  const double wet = cells * std::min(volume / tank.size.prod(), 1.0);
  const bool viscous = liquid.dynamic_viscosity > 0.0 || liquid.rheology.law != RheologyDescription::Law::kNewtonian;
  double bytes = 0.0;
  if (viscous && scene.solver.name != SolverName::kFast) bytes += kViscousSystemBytes;
  if (scene.solver.name == SolverName::kDirect) bytes += viscous ? kFactorBytes * std::cbrt(wet) : kInviscidFactorBytes;
  return cells * kBytesPerCell + wet * bytes;
}

double usableMemory() {
  const double present = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  return std::min(present, memoryLimit("/sys/fs/cgroup", "/proc/self/cgroup"));
}

double memoryLimit(const std::string& mounted, const std::string& own) {
  // A container sees its own group where that of the whole machine would be, whatever name that has outside.
  fs::path unified, memory;
  std::ifstream lines(own);
  for (std::string line; std::getline(lines, line);) {
    // NUMBER:CONTROLLERS:GROUP, of version 2 without controllers
    const auto first = line.find(':');
    const auto second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    if (controllers == ",,") unified = line.substr(second + 1);
    if (controllers.find(",memory,") != std::string::npos) memory = line.substr(second + 1);
  }
  return std::min(limitAlong(mounted, unified, "memory.max"),
                  limitAlong(fs::path(mounted) / "memory", memory, "memory.limit_in_bytes"));
}

}  // namespace monolith
