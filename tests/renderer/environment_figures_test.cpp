#include "renderer/study/environment_figures.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

TEST(EnvironmentFigures, StopWithinTheReference) {
  const LatLong grey(8, 4, std::vector<float>(3 * 8 * 4, 0.5F));
  // With the first picture of samples the share rises.
  int told = 0;
  const auto stopped = environment_figures(grey, [&](double share, const std::string&) {
    EXPECT_EQ(share, 0);
    return ++told < 6;
  });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
  EXPECT_EQ(told, 6);
}

}  // namespace
}  // namespace lumifield
