#include "renderer/study/relative_rmse.h"

#include <cmath>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

TEST(RelativeRmse, IsTheRootMeanSquareOverTheMeanOfTheReference) {
  RelativeRmse error;
  EXPECT_TRUE(std::isnan(error.value()));
  // Errors 3 and 4: their root mean square √12.5; the reference's mean is 4, its own root mean square √34.
  error.add(4, 1);
  error.add(3, 7);
  EXPECT_DOUBLE_EQ(error.value(), std::sqrt(12.5) / 4);
}

TEST(RelativeRmse, OfAPictureCountsWhatTheReferenceCovers) {
  Picture reference{3, 1, {1, 2, 3, 4, 5, 9, 70, 70, 70}, {1, 0.5F, 0}, {}};
  Picture picture = reference;
  EXPECT_EQ(relative_rmse(picture, reference), 0);
  picture.rgb[1] += 6;
  picture.rgb[6] += 100;
  EXPECT_NEAR(relative_rmse(picture, reference), std::sqrt(6.0) / 4, 1e-12);
}

}  // namespace
}  // namespace lumifield
