#include "solve/row_field.h"

#include <gtest/gtest.h>

#include <random>

namespace monolith {
namespace {

class RowFieldTest : public testing::TestWithParam<std::array<bool, 3>> {
 protected:
  // The same along most rows, and anything at all in a few.
  RowFieldTest() : l({9, 6, 5}, GetParam()), plain(l.size, 0.0F) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int k = 0; k < l.faceEnd(2); ++k) {
      for (int j = 0; j < l.faceEnd(1); ++j) {
        const bool boundary = unit(random) < 0.2F;
        for (int i = 0; i < l.faceEnd(0); ++i) plain[l.index(i, j, k)] = boundary ? unit(random) : 2.0F;
      }
    }
    fillHalo(l, plain);
  }
  void expectPlain(const RowField<float>& field) const {
    for (std::ptrdiff_t f = 0; f < static_cast<std::ptrdiff_t>(l.size); ++f) ASSERT_EQ(field[f], plain[f]) << f;
  }

  Lattice l;
  std::vector<float> plain;
};

TEST_P(RowFieldTest, HoldsWhatWasPackedWithItsImages) {
  RowField<float> field;
  EXPECT_TRUE(field.empty());
  field.pack(l, plain);
  expectPlain(field);
  // A copy does not change with the original.
  const RowField<float> copy = field;
  field.transform(field, [](std::ptrdiff_t, float value) { return 3.0F * value; });
  expectPlain(copy);
  EXPECT_FALSE(field == copy);
  for (auto& value : plain) value *= 3.0F;
  expectPlain(field);
}

TEST_P(RowFieldTest, PlanesAreWrittenOneByOne) {
  RowField<float> field;
  field.pack(l, plain);
  std::vector<float> plane;
  const int k = 2;
  field.unpackPlane(k, plane);
  plane[l.index(4, 3, k) - l.planeBegin(k)] = 7.0F;
  field.packPlane(k, plane);
  field.shareImages();
  plain[l.index(4, 3, k)] = 7.0F;
  fillHalo(l, plain);
  expectPlain(field);
  EXPECT_EQ(field.row(l.index(-1, 3, k))[5], 7.0F);
}

TEST_P(RowFieldTest, KeepsItsEntriesUnlessTheLatticeIsAnother) {
  RowField<float> field, other;
  field.pack(l, plain);
  field.reshape(l);
  expectPlain(field);
  other.pack(l, plain);
  EXPECT_TRUE(field == other);
  const Lattice larger({10, 6, 5}, l.periodic);
  field.reshape(larger);
  for (std::ptrdiff_t f = 0; f < static_cast<std::ptrdiff_t>(larger.size); ++f) ASSERT_EQ(field[f], 0.0F);
}

INSTANTIATE_TEST_SUITE_P(Axes, RowFieldTest,
                         testing::Values(std::array<bool, 3>{false, false, false},
                                         std::array<bool, 3>{true, true, true}, std::array<bool, 3>{false, true, false},
                                         std::array<bool, 3>{true, false, true}));

}  // namespace
}  // namespace monolith
