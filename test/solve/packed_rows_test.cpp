#include "solve/packed_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace monolith {
namespace {

TEST(PackedRows, GiveBackEveryBit) {
  const Lattice l({5, 4, 3}, {false, true, false});
  std::vector<double> field(l.size, 0.0);
  const auto row = l.index(0, 1, 1) - Lattice::kLowHalo, next = row + l.stride[1];
  // Two zeros are not the same.
  field[row + 3] = -0.0;
  field[next] = std::numeric_limits<double>::quiet_NaN();
  field.back() = 1e-320;
  std::vector<double> back(3, 7.0);
  const PackedRows<double> packed(l, field);
  packed.unpack(back);
  ASSERT_EQ(back.size(), field.size());
  EXPECT_EQ(std::memcmp(back.data(), field.data(), field.size() * sizeof(double)), 0);
  const std::size_t rows = l.size / l.stride[1], width = l.stride[1];
  EXPECT_EQ(packed.size(), rows - 3 + 3 * width);
}

TEST(PackedRows, TakeNextToNothingOfWhatRests) {
  const Lattice l({16, 16, 16}, {false, false, false});
  std::vector<double> pressure(l.size);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) std::fill_n(pressure.begin() + l.index(-2, j, k), l.stride[1], 16.0 - k);
  }
  EXPECT_LE(PackedRows<double>(l, pressure).size(), l.size / 20);
  EXPECT_EQ(PackedRows<double>(l, std::vector<double>()).size(), 0u);
}

}  // namespace
}  // namespace monolith
