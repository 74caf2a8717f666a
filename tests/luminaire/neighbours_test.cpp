#include "luminaire/neighbours.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>

namespace lumifield {
namespace {

class NeighboursTest : public testing::Test {
 protected:
  void put(CellIndex cell, std::vector<float> value) {
    const int pixels = static_cast<int>(value.size());
    images_[cell] = {pixels, 1, 1, std::move(value), {}, {}};
  }
  double difference(CellIndex cell) const {
    return neighbour_difference(sampling_, cell, [&](CellIndex at) {
      const auto found = images_.find(at);
      return found == images_.end() ? nullptr : &found->second;
    });
  }

  Sampling sampling_{BasisKind::bell, {7.5, 7.5}, 3, 3, {0, 0}};
  std::map<CellIndex, CellImage> images_;
};

TEST_F(NeighboursTest, ComparesWithTheMeanOfThoseThatAreMeasured) {
  put({1, 1}, {1, 3});
  put({0, 1}, {1, 1});
  put({1, 2}, {3, 1});
  put({0, 0}, {100, 100});  // diagonal: not beside it
  // N = (2, 1): (1 + 2) / (3 + 4).
  EXPECT_NEAR(difference({1, 1}), 3.0 / 7, 1e-7);
}

TEST_F(NeighboursTest, IsZeroForAlikeAndOneForNothingInCommon) {
  put({0, 0}, {2, 0});
  put({0, 1}, {2, 0});
  EXPECT_EQ(difference({0, 0}), 0);
  put({0, 1}, {0, 5});
  EXPECT_EQ(difference({0, 0}), 1);
  put({0, 1}, {-2, 0});
  EXPECT_EQ(difference({0, 0}), 1);
}

TEST_F(NeighboursTest, IsUnknownAloneUnmeasuredAndInTheDark) {
  EXPECT_TRUE(std::isnan(difference({0, 0})));
  put({0, 0}, {0, 0});
  EXPECT_TRUE(std::isnan(difference({0, 0})));
  put({1, 0}, {0, 0});
  EXPECT_TRUE(std::isnan(difference({0, 0})));
}

}  // namespace
}  // namespace lumifield
