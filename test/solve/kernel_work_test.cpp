#include "solve/kernel_work.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <thread>

#include "solve/stokes_stencil.h"

namespace monolith {
namespace {

// Of one divergence in a closed, full tank of n^3 cells.
KernelWork workOfDivergence(int n) {
  StaggeredCoefficients<float> c;
  c.resize(Lattice({n, n, n}, {false, false, false}), false);
  const Lattice& l = c.lattice;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const int at[3] = {i, j, k};
        c.has_pressure[l.index(i, j, k)] = 1;
        for (int a = 0; a < 3; ++a) {
          const auto f = l.index(i, j, k);
          c.mass[a][f] = c.own_fluid[a][f] = at[a] > 0 ? 1.0f : 0.0f;
        }
      }
    }
  }
  CellBlocks<float> cells;
  buildCellBlocks(c, cells);
  std::vector<float> u(l.size, 1.0f), out(l.size, 0.0f);
  kernelWork() = KernelWork();
  applyDivergence(l, cells, Faces<const float>{u.data(), u.data(), u.data()}, 0.0f, static_cast<const float*>(nullptr),
                  out.data());
  return kernelWork();
}

// Three components in, one out: 16 bytes; six products and five sums, and the sign.
TEST(KernelWork, IsWhatACellTakesTimesTheCells) {
  for (const int n : {8, 16, 32}) {
    const KernelWork work = workOfDivergence(n);
    EXPECT_EQ(work.bytes, 16.0 * n * n * n);
    EXPECT_EQ(work.flops, 12.0 * n * n * n);
  }
}

TEST(KernelWork, DoesNotDependOnTheNumberOfThreads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const KernelWork one = workOfDivergence(32);
  omp_set_num_threads(2);
  const KernelWork two = workOfDivergence(32);
  omp_set_num_threads(before);
  EXPECT_EQ(one.bytes, two.bytes);
  EXPECT_EQ(one.flops, two.flops);
}

TEST(KernelWork, IsThatOfTheThreadWhichAsks) {
  (void)workOfDivergence(8);
  const KernelWork mine = kernelWork();
  std::thread([] { (void)workOfDivergence(16); }).join();
  EXPECT_EQ(kernelWork().bytes, mine.bytes);
}

}  // namespace
}  // namespace monolith
