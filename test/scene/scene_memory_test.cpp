#include "scene/scene_memory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "temporary_folder.h"

namespace monolith {
namespace {

class MemoryLimit : public ::testing::Test {
 protected:
  double limit(const std::string& own) { return memoryLimit(folder_.path() + "/groups", folder_.write("own", own)); }

  TemporaryFolder folder_;
};

TEST_F(MemoryLimit, WithoutGroupsThereIsNone) {
  EXPECT_TRUE(std::isinf(memoryLimit(folder_.path() + "/nowhere", folder_.path() + "/nothing")));
  EXPECT_TRUE(std::isinf(limit("0::/\n")));
  folder_.write("groups/memory.max", "max\n");
  EXPECT_TRUE(std::isinf(limit("0::/\n")));
}

TEST_F(MemoryLimit, IsThatOfTheContainer) {
  folder_.write("groups/memory.max", "1073741824\n");
  EXPECT_EQ(limit("0::/\n"), 1073741824.0);
  // Named as outside of it.
  EXPECT_EQ(limit("0::/docker/0123\n"), 1073741824.0);
  EXPECT_EQ(memoryLimit(folder_.path() + "/groups", folder_.path() + "/nothing"), 1073741824.0);
}

TEST_F(MemoryLimit, IsTheLeastOfTheGroupsOnTheWay) {
  folder_.write("groups/user.slice/memory.max", "2000\n");
  folder_.write("groups/user.slice/run.scope/memory.max", "max\n");
  folder_.write("groups/other.slice/memory.max", "10\n");
  EXPECT_EQ(limit("0::/user.slice/run.scope\n"), 2000.0);
  folder_.write("groups/user.slice/run.scope/memory.max", "1000\n");
  EXPECT_EQ(limit("0::/user.slice/run.scope\n"), 1000.0);
  EXPECT_EQ(limit("0::/user.slice\n"), 2000.0);
}

TEST_F(MemoryLimit, OfVersionOneIsThatOfItsMemoryGroups) {
  folder_.write("groups/memory/memory.limit_in_bytes", "9223372036854771712\n");
  folder_.write("groups/memory/jobs/memory.limit_in_bytes", "5000\n");
  EXPECT_EQ(limit("12:cpu,cpuacct:/\n4:memory:/jobs\n0::/\n"), 5000.0);
  EXPECT_GT(limit("12:cpu,cpuacct:/jobs\n4:memory:/\n"), 1e18);
}

TEST(SceneMemory, ThereIsAPlausibleNumberOfBytes) {
  EXPECT_GT(usableMemory(), 1e7);
  EXPECT_LT(usableMemory(), 1e15);
}

TEST(SceneMemory, SolversNeedWhatTheirSystemsTake) {
  Scene scene;
  scene.tank.cell_width = 1.0 / 32;
  scene.liquid.fill_level = 1.0;
  scene.liquid.dynamic_viscosity = 1.0;
  const double fast = neededMemory(scene);
  scene.solver.name = SolverName::kReference;
  const double reference = neededMemory(scene);
  scene.solver.name = SolverName::kDirect;
  const double direct = neededMemory(scene);
  EXPECT_GT(reference, 5.0 * fast);
  EXPECT_GT(direct, 3.0 * reference);
  // A factor grows faster than the cells that have liquid; without viscosity there is little to factor.
  scene.tank.cell_width *= 0.5;
  EXPECT_GT(neededMemory(scene), 12.0 * direct);
  scene.liquid.fill_level = 0.25;
  EXPECT_LT(neededMemory(scene), 3.0 * direct);
  scene.liquid.boxes.emplace_back(Eigen::Vector3d(0.0, 0.0, 0.25), Eigen::Vector3d(1.0, 1.0, 1.0));
  EXPECT_GT(neededMemory(scene), 12.0 * direct);
  scene.liquid.dynamic_viscosity = 0.0;
  EXPECT_LT(neededMemory(scene), 8.0 * fast * 3.0);
}

}  // namespace
}  // namespace monolith
